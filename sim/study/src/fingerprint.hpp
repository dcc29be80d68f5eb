// Whether two tables are of one thing: 64 bits by FNV-1a, for a label that people may compare, no protection.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace breakaway::study {

class Fingerprint {
 public:
  void mix(std::string_view bytes) {
    for (const char byte : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(byte)) * 0x100000001B3;
  }
  // From the lowest byte on, on every machine.
  void mix(std::uint64_t bits) {
    for (int byte = 0; byte < 64; byte += 8) hash_ = (hash_ ^ ((bits >> byte) & 0xFF)) * 0x100000001B3;
  }
  void mix(double value) { mix(std::bit_cast<std::uint64_t>(value)); }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325;
};

}  // namespace breakaway::study
