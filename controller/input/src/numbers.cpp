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

// The slack keeps a value that has no more digits, in spite of the roundings here.
double rounded(double value, int digits, double (*to_whole)(double), double slack) {
  const double unit = std::pow(10, std::floor(std::log10(value)) + 1 - digits);
  return std::stod(with_digits(to_whole(value / unit * slack) * unit, digits));
}

// The nearest number of so many digits that is not on the other side of the value: above it where `side` is 1, below it
// where that is -1. What is off by less than a double's arithmetic has no other side.
std::string beyond(double value, int digits, double side) {
  constexpr double slack = 1e-13;
  std::string nearest = with_digits(value, digits);
  if (!std::isfinite(value) || value == 0) return nearest;
  const double read = std::stod(nearest);
  if (side * (read - value) >= -slack * std::abs(value)) return nearest;
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) + 1 - digits);
  return with_digits(read + side * unit, digits);
}

}  // namespace

std::string to_text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::string brief(double value) { return with_digits(value, brief_digits); }

std::string brief_up(double value) {
  return brief(value > 0 && std::isfinite(value) ? rounded_up(value, brief_digits) : value);
}

double rounded_up(double value, int digits) { return rounded(value, digits, std::ceil, 1 - 1e-9); }
double rounded_down(double value, int digits) { return rounded(value, digits, std::floor, 1 + 1e-9); }

ComparedNumbers compared(double value, double limit) {
  for (int digits = brief_digits; digits <= all_digits; ++digits) {
    if (with_digits(value, digits) == with_digits(limit, digits)) continue;
    const double side = value > limit ? 1 : -1;
    return {beyond(value, digits, side), beyond(limit, digits, -side)};
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
