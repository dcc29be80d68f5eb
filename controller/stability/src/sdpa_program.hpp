// The program `sdpa`, run on files in a temporary folder.
#pragma once

#include <string>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::stability {

// What `sdpa` writes about a problem in its own sparse format (.dat-s). Errors: the program is not installed, the
// folder for temporary files cannot be written, the program failed.
std::string sdpa_result(const std::string& problem);

}  // namespace breakaway::stability
