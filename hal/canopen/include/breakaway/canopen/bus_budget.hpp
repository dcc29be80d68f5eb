// Does a configuration fit the bus? Worst-case frame lengths of everything that must pass in one period: SYNC, and for
// each axis an RPDO of 4 bytes (6040h, 6071h) and a TPDO of 8 (6041h, 6064h, 6077h).
#pragma once

#include <cstdint>

#include "breakaway/hal/status.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/hal/wire_length.hpp"

namespace breakaway::canopen {

// What else a period must have room for. SDO and heartbeats lose arbitration against SYNC and PDOs and so can hold them
// up by no more than the one frame that is on the wire already; one frame kept free for them, whichever it is, bounds
// that delay and lets them pass. heartbeats: keep room for so many in one period besides.
struct AcyclicTraffic {
  unsigned frames = 1;  // of 8 bytes
  unsigned heartbeats = 0;
};

struct BusBudget {
  std::uint32_t needed_us = 0;     // worst case of a period, rounded up
  std::uint32_t available_us = 0;  // the period, rounded down
  unsigned max_axes = 0;           // that fit this period
  std::uint32_t max_rate_Hz = 0;   // for these axes, rounded down
};

constexpr std::uint64_t bits_per_axis() noexcept { return hal::worst_case_wire_bits(4) + hal::worst_case_wire_bits(8); }

constexpr std::uint64_t bits_per_period(unsigned axes, AcyclicTraffic acyclic = {}) noexcept {
  return hal::worst_case_wire_bits(0) + axes * bits_per_axis() +
         std::uint64_t{acyclic.frames} * hal::worst_case_wire_bits(8) +
         std::uint64_t{acyclic.heartbeats} * hal::worst_case_wire_bits(1);
}

// axes: 1..127; period: above 0, up to 1 h; bit_rate in bit/s: 10'000..1'000'000. Everything else gives all zeros.
constexpr BusBudget bus_budget(unsigned axes, hal::Duration period, std::uint32_t bit_rate,
                               AcyclicTraffic acyclic = {}) noexcept {
  constexpr std::uint64_t nanoseconds_per_second = 1'000'000'000;
  const bool valid = axes >= 1 && axes <= 127 && period > hal::Duration::zero() && period <= std::chrono::hours{1} &&
                     bit_rate >= 10'000 && bit_rate <= 1'000'000;
  if (!valid) return {};
  const std::uint64_t bits = bits_per_period(axes, acyclic);
  const auto period_ns = static_cast<std::uint64_t>(period.count());
  const std::uint64_t available_bits = period_ns * bit_rate / nanoseconds_per_second;
  const std::uint64_t fixed_bits = bits_per_period(0, acyclic);
  const std::uint64_t free_bits = available_bits > fixed_bits ? available_bits - fixed_bits : 0;
  const std::uint64_t max_axes = free_bits / bits_per_axis();
  return {.needed_us = static_cast<std::uint32_t>((bits * 1'000'000 + bit_rate - 1) / bit_rate),
          .available_us = static_cast<std::uint32_t>(period_ns / 1000),
          .max_axes = static_cast<unsigned>(max_axes < 127 ? max_axes : 127),
          .max_rate_Hz = static_cast<std::uint32_t>(bit_rate / bits)};
}

// ok; bus_overload (detail: the microseconds needed; bus_budget has the other figures); or invalid_argument (detail 1:
// axes, 2: period, 3: bit rate outside the ranges of bus_budget).
constexpr hal::Status check_bus_budget(unsigned axes, hal::Duration period, std::uint32_t bit_rate,
                                       AcyclicTraffic acyclic = {}) noexcept {
  if (axes < 1 || axes > 127) return {hal::StatusCode::invalid_argument, 1};
  if (period <= hal::Duration::zero() || period > std::chrono::hours{1}) return {hal::StatusCode::invalid_argument, 2};
  if (bit_rate < 10'000 || bit_rate > 1'000'000) return {hal::StatusCode::invalid_argument, 3};
  const BusBudget budget = bus_budget(axes, period, bit_rate, acyclic);
  if (axes > budget.max_axes) return {hal::StatusCode::bus_overload, budget.needed_us};
  return {};
}

}  // namespace breakaway::canopen
