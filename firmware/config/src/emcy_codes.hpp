// Error codes of EMCY in a file: "FF01h" is one, "42xxh" all of its class.
#pragma once

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// An array of at most EmcyCodes::most of them, none of which another one holds.
Value emcy_codes(canopen::EmcyCodes& to);

}  // namespace breakaway::config
