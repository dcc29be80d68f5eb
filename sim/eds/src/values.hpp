// Values as an EDS has them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace breakaway::eds {

// A number under two node ids: where it follows the id, it is written as a sum of that.
struct NumberUnderIds {
  std::int64_t first = 0, second = 0;
  std::uint8_t first_id = 1, second_id = 2;  // they differ
  int hexadecimal_digits = 0;                // 0: decimal, and signed
};

// Returns nothing for a number that changes with the node id in any other way than by its sum.
std::optional<std::string> value_text(const NumberUnderIds& number);

}  // namespace breakaway::eds
