// The parameters of friction laws are checked here; each check throws an InputError that names the parameter.
#pragma once

#include <cmath>
#include <string>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::model {

inline void require_finite(const char* name, double value) {
  if (!std::isfinite(value)) throw InputError{name, "is not a finite number; correct it"};
}

inline void require_unit_interval(const char* name, double value) {
  if (value >= 0 && value <= 1) return;
  throw InputError{name, "is " + to_text(value) + "; give a number in [0, 1]"};
}

inline void require_ordered(const char* lower_name, double lower, const char* upper_name, double upper) {
  require_positive(lower_name, lower);
  require_positive(upper_name, upper);
  if (lower <= upper) return;
  throw InputError{lower_name, "is " + to_text(lower) + ", above " + upper_name + " = " + to_text(upper) +
                                   "; exchange or correct them"};
}

}  // namespace breakaway::model
