#include "breakaway/input/numbers.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "breakaway/input/input_error.hpp"

namespace breakaway {

std::string to_text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

void require_positive(std::string_view name, double value) {
  if (std::isfinite(value) && value > 0) return;
  throw InputError{std::string{name}, "is " + to_text(value) + "; give a finite number above 0"};
}

void require_not_negative(std::string_view name, double value) {
  if (std::isfinite(value) && value >= 0) return;
  throw InputError{std::string{name}, "is " + to_text(value) + "; give a finite number, 0 or above"};
}

}  // namespace breakaway
