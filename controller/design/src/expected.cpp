#include "breakaway/design/expected.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace breakaway::design {

std::string to_text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::optional<Error> unless_positive(std::string_view name, double value) {
  if (std::isfinite(value) && value > 0) return std::nullopt;
  return Error{std::string(name) + " is " + to_text(value) + "; give a finite number above 0"};
}

std::optional<Error> unless_not_negative(std::string_view name, double value) {
  if (std::isfinite(value) && value >= 0) return std::nullopt;
  return Error{std::string(name) + " is " + to_text(value) + "; give a finite number, 0 or above"};
}

}  // namespace breakaway::design
