// The bus budget: do so many axes at this period fit the bus?
//
// One period must let pass SYNC and, for each axis, an RPDO of 4 bytes (6040h, 6071h) and a TPDO of 8 (6041h, 6064h,
// 6077h). Every frame is counted at its worst-case length, with all stuff bits that its payload could need.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string_view>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/hal/wire_length.hpp"

namespace breakaway::canopen {

// The traffic that a period must have room for besides. SDO and heartbeats lose arbitration against SYNC and PDOs, so
// they can hold them up by no more than the one frame that is on the wire already; one frame kept free, whichever it
// is, bounds that delay and lets them pass.
struct AcyclicTraffic {
  unsigned frames = 1;      // of 8 bytes
  unsigned heartbeats = 0;  // that must all pass in one period besides
};

struct BusBudget {
  std::uint32_t needed_us = 0;     // worst case of a period, rounded up
  std::uint32_t available_us = 0;  // the period, rounded down
  hal::Duration least_period{};    // that these axes fit: needed_us
  unsigned max_axes = 0;           // that fit this period
  std::uint32_t max_rate_Hz = 0;   // for these axes, rounded down
};

enum class BusFit : std::uint8_t {
  fits,
  axes_out_of_range,
  period_out_of_range,
  bit_rate_out_of_range,
  overloaded,  // bus_budget() has the figures
};

constexpr std::string_view to_string(BusFit fit) noexcept {
  switch (fit) {
    case BusFit::fits:
      return "the axes fit the bus";
    case BusFit::axes_out_of_range:
      return "axes must be 1 to 127";
    case BusFit::period_out_of_range:
      return "period must be above 0 and at most 1 hour";
    case BusFit::bit_rate_out_of_range:
      return "bit_rate must be 10000 to 1000000 bit/s";
    case BusFit::overloaded:
      return "the axes do not fit the bus: choose a longer period, a higher bit_rate, or fewer axes";
  }
  return "unknown fit";
}

constexpr std::uint64_t bits_per_axis() noexcept { return hal::worst_case_wire_bits(4) + hal::worst_case_wire_bits(8); }

constexpr std::uint64_t bits_per_period(unsigned axes, AcyclicTraffic acyclic = {}) noexcept {
  return hal::worst_case_wire_bits(0) + axes * bits_per_axis() +
         std::uint64_t{acyclic.frames} * hal::worst_case_wire_bits(8) +
         std::uint64_t{acyclic.heartbeats} * hal::worst_case_wire_bits(1);
}

namespace internal {

// Axes, period and bit rate are in the ranges for which the figures below do not overflow and mean something.
constexpr BusFit check_ranges(unsigned axes, hal::Duration period, std::uint32_t bit_rate) noexcept {
  if (axes < 1 || axes > max_node_id) return BusFit::axes_out_of_range;
  if (period <= hal::Duration::zero() || period > std::chrono::hours{1}) return BusFit::period_out_of_range;
  if (bit_rate < 10'000 || bit_rate > 1'000'000) return BusFit::bit_rate_out_of_range;
  return BusFit::fits;
}

}  // namespace internal

// The figures for axes of 1 to 127, a period above 0 and up to an hour, and a bit_rate of 10'000 to 1'000'000 bit/s;
// all zeros for anything else.
constexpr BusBudget bus_budget(unsigned axes, hal::Duration period, std::uint32_t bit_rate,
                               AcyclicTraffic acyclic = {}) noexcept {
  constexpr std::uint64_t nanoseconds_per_second = 1'000'000'000;
  if (internal::check_ranges(axes, period, bit_rate) != BusFit::fits) return {};
  const std::uint64_t bits = bits_per_period(axes, acyclic);
  const auto needed_us = static_cast<std::uint32_t>((bits * 1'000'000 + bit_rate - 1) / bit_rate);
  const auto period_ns = static_cast<std::uint64_t>(period.count());
  const std::uint64_t available_bits = period_ns * bit_rate / nanoseconds_per_second;
  const std::uint64_t fixed_bits = bits_per_period(0, acyclic);
  const std::uint64_t free_bits = available_bits > fixed_bits ? available_bits - fixed_bits : 0;
  const std::uint64_t max_axes = free_bits / bits_per_axis();
  return {.needed_us = needed_us,
          .available_us = static_cast<std::uint32_t>(period_ns / 1000),
          .least_period = std::chrono::microseconds{needed_us},
          .max_axes = static_cast<unsigned>(max_axes < max_node_id ? max_axes : max_node_id),
          .max_rate_Hz = static_cast<std::uint32_t>(bit_rate / bits)};
}

// Returns `fits`, `overloaded`, or which argument is outside its range.
[[nodiscard]] constexpr BusFit check_bus_budget(unsigned axes, hal::Duration period, std::uint32_t bit_rate,
                                                AcyclicTraffic acyclic = {}) noexcept {
  const BusFit ranges = internal::check_ranges(axes, period, bit_rate);
  if (ranges != BusFit::fits) return ranges;
  return axes <= bus_budget(axes, period, bit_rate, acyclic).max_axes ? BusFit::fits : BusFit::overloaded;
}

// From the start of a period to the SYNC at which its commands act: what the RPDOs take at their longest, so that their
// stuff bits do not move it, and time for the step that computes them, a twentieth of the period and at most 100 us. A
// bus with less room than that has half of what is left. 0 where the axes do not fit the bus.
constexpr hal::Duration sync_offset(unsigned axes, hal::Duration period, std::uint32_t bit_rate) noexcept {
  if (check_bus_budget(axes, period, bit_rate) != BusFit::fits) return hal::Duration::zero();
  constexpr hal::Duration longest_step = std::chrono::microseconds{100};
  const hal::Duration free = period - hal::wire_time(static_cast<unsigned>(bits_per_period(axes)), bit_rate);
  const hal::Duration step = std::min({period / 20, longest_step, free / 2});
  return hal::wire_time(axes * hal::worst_case_wire_bits(4), bit_rate) + step;
}

}  // namespace breakaway::canopen
