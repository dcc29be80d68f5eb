// How a check of a DesignReport is made.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "breakaway/design/report.hpp"
#include "brief.hpp"

namespace breakaway::design::detail {

enum class Equality { fails, holds };
constexpr double bound_rounding = 1e-12;  // relative: a tolerance set to the very value of its bound is not below it

// Where the value is infinite, what the check asks for is to be had at no price.
inline std::string unmet(const std::string& relation, double value, double limit) {
  const auto [value_text, limit_text] = compared(value, limit);
  if (std::isinf(value)) return "no finite number suffices, and it must be " + relation + limit_text;
  return value_text + " is not " + relation + limit_text;
}

// A required check of value < limit. `what` names both in words.
inline Check below(std::string name, std::string source, double value, double limit, const std::string& what,
                   const std::string& remedy, Equality equality = Equality::fails) {
  const bool holds = value < limit || (equality == Equality::holds && value <= limit * (1 + bound_rounding));
  const std::string relation = equality == Equality::holds ? "at most " : "below ";
  const std::string reason =
      what + ": " +
      (holds ? brief(value) + " is " + relation + brief(limit) : unmet(relation, value, limit) + "; " + remedy);
  // What rounding let pass has no margin.
  const double margin = limit - value;
  return {std::move(name), true, holds, holds ? std::max(margin, 0.0) : margin, std::move(source), reason};
}

}  // namespace breakaway::design::detail
