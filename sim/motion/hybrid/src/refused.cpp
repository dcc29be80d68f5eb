#include "breakaway/hybrid/refused.hpp"

#include <array>
#include <cstdio>

namespace breakaway::hybrid {

std::string shown(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", number);
  return text.data();
}

}  // namespace breakaway::hybrid
