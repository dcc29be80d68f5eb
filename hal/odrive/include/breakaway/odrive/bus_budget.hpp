// The bus budget: do so many axes at this period fit the bus?
//
// One period must let pass for each axis Set_Input_Torque, and Get_Encoder_Estimates and Get_Torques as often as they
// come in it, each of 8 bytes; where they are polled, with a question before each. Every frame is counted at its
// worst-case length. One frame is kept free for what is not cyclic: heartbeats have a lower identifier than all of
// these and go first, and what sets a drive up is one frame a period.
#pragma once

#include <cstdint>

#include "breakaway/hal/network_config.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/hal/wire_length.hpp"
#include "breakaway/odrive/drive_config.hpp"

namespace breakaway::odrive {

struct BusBudget {
  std::uint32_t needed_us = 0;     // worst case of a period, rounded up
  std::uint32_t available_us = 0;  // the period, rounded down
  std::uint32_t max_rate_Hz = 0;   // for these axes, rounded down

  constexpr bool fits() const noexcept { return needed_us <= available_us; }
};

// What samples cost an axis in a period.
struct Sampling {
  Estimates estimates = Estimates::cyclic;
  hal::Duration estimate_period = std::chrono::milliseconds{1};  // of cyclic ones
};

constexpr std::uint64_t bits_per_axis(const Sampling& sampling, hal::Duration period) noexcept {
  constexpr std::uint64_t message = hal::worst_case_wire_bits(8), question = hal::worst_case_wire_bits(0);
  if (sampling.estimates == Estimates::polled) return 3 * message + 2 * question;
  const auto each = (period + sampling.estimate_period - hal::Duration{1}) / sampling.estimate_period;
  return (1 + 2 * static_cast<std::uint64_t>(each)) * message;
}

// The figures for a period and an estimate_period above 0 and a bit_rate of 10'000 to 1'000'000 bit/s. `free_frames`
// of 8 bytes are kept for what is not cyclic.
constexpr BusBudget bus_budget(unsigned axes, hal::Duration period, std::uint32_t bit_rate, const Sampling& sampling,
                               unsigned free_frames = 1) noexcept {
  const std::uint64_t bits =
      axes * bits_per_axis(sampling, period) + std::uint64_t{free_frames} * hal::worst_case_wire_bits(8);
  return {.needed_us = static_cast<std::uint32_t>((bits * 1'000'000 + bit_rate - 1) / bit_rate),
          .available_us = static_cast<std::uint32_t>(period.count() / 1000),
          .max_rate_Hz = static_cast<std::uint32_t>(bit_rate / bits)};
}

}  // namespace breakaway::odrive
