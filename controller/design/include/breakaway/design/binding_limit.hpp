// What the accuracy of an axis under the coast "brake" is limited by.
#pragma once

#include <string_view>

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design {

struct BindingLimit {
  std::string_view name;         // of what limits most
  double least_tolerance_m = 0;  // that could be certified with half of it
};

// Of encoder, step of force, lag, jitter, force beside the drive's, uncertainties and width of the friction bounds the
// one of which half, with all the rest as it is, would lower the least tolerance most. Takes as much work as eight
// designs. Requires a design of the axes that is possible().
BindingLimit binding_limit(const BrakedClass& axes);

}  // namespace breakaway::design
