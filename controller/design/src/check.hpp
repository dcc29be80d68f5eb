// How a check of a DesignReport is made.
#pragma once

#include <string>
#include <utility>

#include "breakaway/design/report.hpp"
#include "brief.hpp"

namespace breakaway::design::detail {

enum class Equality { fails, holds };
constexpr double bound_rounding = 1e-12;  // relative: a tolerance set to the very value of its bound is not below it

// A required check of value < limit. `what` names both in words.
inline Check below(std::string name, std::string source, double value, double limit, const std::string& what,
                   const std::string& remedy, Equality equality = Equality::fails) {
  const bool holds = value < limit || (equality == Equality::holds && value <= limit * (1 + bound_rounding));
  const std::string relation = equality == Equality::holds ? "at most " : "below ";
  std::string reason = what + ": " + brief(value) + (holds ? " is " : " is not ") + relation + brief(limit);
  if (!holds) reason += "; " + remedy;
  return {std::move(name), true, holds, limit - value, std::move(source), std::move(reason)};
}

}  // namespace breakaway::design::detail
