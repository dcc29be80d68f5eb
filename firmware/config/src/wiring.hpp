// [target]: the board of a node.
#pragma once

#include <string>

#include "breakaway/config/toml_section.hpp"
#include "breakaway/firmware/wiring.hpp"

namespace breakaway::config {

// "PB8", as the data sheet writes it; or "none".
std::string pin_text(firmware::Pin p);

// Throws InputError with the remedy: a pin that cannot have its function, or that has two.
firmware::Wiring read_wiring(const Section& target);

}  // namespace breakaway::config
