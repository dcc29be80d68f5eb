// An identification in lines for people.
#pragma once

#include <string>

#include "breakaway/evaluation/identification.hpp"

namespace breakaway::evaluation {

std::string summary(const Identification& found);

}  // namespace breakaway::evaluation
