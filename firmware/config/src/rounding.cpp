#include "breakaway/config/rounding.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace breakaway::config {
namespace {

// The slack keeps a value that has no more digits, in spite of the roundings here.
double rounded(double value, int digits, double (*to_whole)(double), double slack) {
  const double unit = std::pow(10, std::floor(std::log10(value)) + 1 - digits);
  return std::stod(fmt::format("{:.{}e}", to_whole(value / unit * slack) * unit, digits - 1));
}

}  // namespace

double rounded_up(double value, int digits) { return rounded(value, digits, std::ceil, 1 - 1e-9); }
double rounded_down(double value, int digits) { return rounded(value, digits, std::floor, 1 + 1e-9); }

}  // namespace breakaway::config
