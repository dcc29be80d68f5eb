#include "error_text.hpp"

#include <fmt/format.h>

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/cia402/state.hpp"

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

std::string error_text(const StepRecord& step) {
  if (step.code_text.empty()) return error_text(step.fault_code, step.error_register);
  return std::string{step.code_text};
}

std::string why_disabled(const StepRecord& step) {
  if (!step.setup_text.empty()) return std::string{step.setup_text};
  return fmt::format("statusword {:04X}h, {}", step.statusword, cia402::what_keeps_disabled(step.statusword));
}

}  // namespace breakaway::linux_node
