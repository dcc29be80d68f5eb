// What the images that replay tapes have in common: from a tape to results, and the marks between which an emulator
// counts instructions. The first pair of marks has nothing in between.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "replay.hpp"
#include "semihosting.hpp"

extern "C" {
[[gnu::noinline]] inline void count_begin() { asm volatile("" ::: "memory"); }
[[gnu::noinline]] inline void count_end() { asm volatile("" ::: "memory"); }
}

namespace breakaway::emulated {

enum ReplayExit : std::uint32_t { done = 0, no_tape = 1, cannot_write = 2 };

// replay(state, step) gives the Result of a step.
template <class Result, class State, class Replay>
ReplayExit replay_file(State state, std::string_view tape_name, std::string_view results_name, const Replay& replay) {
  HostFile tape{tape_name, OpenMode::read_binary};
  HostFile results{results_name, OpenMode::write_binary};
  if (!tape.is_open()) return no_tape;
  if (!results.is_open()) return cannot_write;
  std::array<TapeStep, 16> steps;
  std::array<Result, 16> outcomes;
  while (const std::size_t count = tape.read(steps.data(), sizeof steps) / sizeof(TapeStep)) {
    for (std::size_t i = 0; i < count; ++i) outcomes[i] = replay(state, steps[i]);
    if (!results.write(outcomes.data(), count * sizeof(Result))) return cannot_write;
  }
  return done;
}

}  // namespace breakaway::emulated
