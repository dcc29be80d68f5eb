#include "error_text.hpp"

#include <fmt/format.h>

#include "breakaway/canopen/emcy.hpp"

namespace breakaway::linux_node {

std::string error_text(std::uint16_t code, std::uint8_t error_register) {
  std::string text = fmt::format("error code {:04X}h: {}", code, canopen::error_class(code));
  if (error_register == 0) return text;
  text += fmt::format("; error register {:02X}h:", error_register);
  for (std::size_t bit = 0; bit < canopen::error_register_bits.size(); ++bit)
    if ((error_register >> bit & 1) != 0) text += fmt::format(" {},", canopen::error_register_bits[bit]);
  text.pop_back();
  return text;
}

}  // namespace breakaway::linux_node
