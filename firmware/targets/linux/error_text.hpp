// What a drive said of its error, for people.
#pragma once

#include <cstdint>
#include <string>

namespace breakaway::linux_node {

// code: of EMCY or 603Fh. error_register: 1001h, 0 where it is not known.
std::string error_text(std::uint16_t code, std::uint8_t error_register);

}  // namespace breakaway::linux_node
