#include "breakaway/input/numbers.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "breakaway/input/input_error.hpp"

namespace breakaway {
namespace {

constexpr int brief_digits = 6;
constexpr int all_digits = 17;  // that two doubles differ in, if they do

std::string with_digits(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return text.data();
}

}  // namespace

std::string to_text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::string brief(double value) { return with_digits(value, brief_digits); }

ComparedNumbers compared(double value, double limit) {
  ComparedNumbers texts;
  for (int digits = brief_digits; digits <= all_digits; ++digits) {
    texts = {with_digits(value, digits), with_digits(limit, digits)};
    if (texts.value != texts.limit) return texts;
  }
  return {brief(value), brief(limit)};
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
