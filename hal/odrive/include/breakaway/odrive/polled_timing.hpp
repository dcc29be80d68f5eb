// PolledTiming: when in a period the commands of polled drives act and their samples are taken.
//
// There is no SYNC. All that the loop sends leaves as a step begins, commands first, then the questions, axis by axis;
// a frame acts when it has passed what was before it on the wire. That is the heartbeat of any drive, which has a lower
// identifier and comes by the drive's own clock, and the answers to earlier questions. The bus carries nothing else.
#pragma once

#include <chrono>
#include <cstdint>

#include "breakaway/hal/time.hpp"
#include "breakaway/hal/wire_length.hpp"

namespace breakaway::odrive {

// A drive's own loop, at 8 kHz, takes a command or a question up as much later at most.
inline constexpr hal::Duration drive_cycle = std::chrono::microseconds{125};

// Since the step began.
struct PolledTiming {
  hal::Duration first{};     // no command acts before this, and no sample is taken
  hal::Duration last{};      // every command acts by this, and every sample is taken
  hal::Duration answered{};  // the bus is quiet by this, with what is not cyclic

  // By which commands and samples are off whole periods, one against another.
  constexpr hal::Duration jitter() const noexcept { return last - first; }
};

// axes: 1 or more. bit_rate: bit/s, above 0. heartbeats: of each drive in a period, at most.
constexpr PolledTiming polled_timing(unsigned axes, std::uint32_t bit_rate, unsigned heartbeats = 1) noexcept {
  constexpr unsigned message = hal::worst_case_wire_bits(8), question = hal::worst_case_wire_bits(0);
  constexpr unsigned shortest_command = 47 + 8 * 8;  // without a stuff bit
  constexpr unsigned asked = 2 * (question + message);
  const unsigned commands = axes * (1 + heartbeats) * message;  // and the heartbeats
  const unsigned to_last_sample = commands + (axes - 1) * asked + question;
  // Besides, one frame a period sets a drive up or asks it something.
  const unsigned all = commands + axes * asked + question + message;
  return {.first = hal::wire_time(shortest_command, bit_rate),
          .last = hal::wire_time(to_last_sample, bit_rate) + drive_cycle,
          .answered = hal::wire_time(all, bit_rate) + drive_cycle};
}

}  // namespace breakaway::odrive
