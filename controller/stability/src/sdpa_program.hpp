// The program `sdpa`, run on files in a temporary folder.
#pragma once

#include <string>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::stability {

// Returns what `sdpa` writes about a problem in its own sparse format (.dat-s). It fails when the program is not
// installed or fails itself, and when the folder for temporary files cannot be written.
std::string sdpa_result(const std::string& problem);

}  // namespace breakaway::stability
