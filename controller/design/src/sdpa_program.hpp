// The program `sdpa`, run on files in a temporary folder.
#pragma once

#include <string>

#include "breakaway/design/expected.hpp"

namespace breakaway::design {

// What `sdpa` writes about a problem in its own sparse format (.dat-s). Errors: the program is not installed, the
// folder for temporary files cannot be written, the program failed.
Expected<std::string> sdpa_result(const std::string& problem);

}  // namespace breakaway::design
