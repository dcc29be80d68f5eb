// Registers of a peripheral that hold what they are given, whatever is written to them, and count how often each is
// read.
#pragma once

#include <cstdint>
#include <map>

namespace breakaway::testing {

struct FixedRegisters {
  std::map<std::uint32_t, std::uint32_t> values;  // by offset; 0 where none is given
  std::map<std::uint32_t, int> reads;

  std::uint32_t read(std::uint32_t offset) noexcept {
    ++reads[offset];
    return values[offset];
  }
  void write(std::uint32_t, std::uint32_t) noexcept {}
  void pend_transmit_interrupt() noexcept {}
};

}  // namespace breakaway::testing
