// Numbers in sentences.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace breakaway::design::detail {

// People read six digits.
inline std::string brief(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

}  // namespace breakaway::design::detail
