// Checks of shape parameters: each throws std::invalid_argument naming the parameter.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace breakaway::friction {

inline void require_positive(const char* name, double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw std::invalid_argument(std::string(name) + " must be positive and finite, got " + std::to_string(value));
  }
}

inline void require_finite(const char* name, double value) {
  if (!std::isfinite(value)) throw std::invalid_argument(std::string(name) + " must be finite");
}

inline void require_unit_interval(const char* name, double value) {
  if (!(value >= 0 && value <= 1)) {
    throw std::invalid_argument(std::string(name) + " must lie in [0, 1], got " + std::to_string(value));
  }
}

inline void require_ordered(const char* lower_name, double lower, const char* upper_name, double upper) {
  require_positive(lower_name, lower);
  require_positive(upper_name, upper);
  if (lower > upper) {
    throw std::invalid_argument(std::string(lower_name) + " must not exceed " + upper_name + ", got " +
                                std::to_string(lower) + " > " + std::to_string(upper));
  }
}

}  // namespace breakaway::friction
