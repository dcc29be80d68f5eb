#include "odrive_side.hpp"

#include <fmt/format.h>

#include "breakaway/odrive/fault_code.hpp"
#include "breakaway/odrive/master.hpp"
#include "breakaway/odrive/messages.hpp"

namespace breakaway::linux_node {

std::optional<std::uint8_t> OdriveSide::heard_node(const hal::CanFrame& frame) {
  if (!odrive::as_heartbeat(frame)) return {};
  return odrive::node_id_of(frame.id);
}

std::string OdriveSide::other_master(const hal::CanFrame& frame, const hal::NetworkConfig& /*network*/,
                                     std::span<const std::uint8_t> nodes) {
  for (const std::uint8_t node : nodes)
    if (odrive::Master::is_command(frame, node)) return fmt::format("it commands node {}", node);
  return {};
}

std::string OdriveSide::why_standing(const Drive& drive) {
  if (const std::uint16_t code = drive.last_error_code(); code != 0)
    return fmt::format("it does not get ready, and tells why: {}", odrive::fault_text(code));
  return fmt::format("{}", to_string(drive.setup_status()));
}

void OdriveSide::note(const Drive& drive, StepRecord& step) {
  if (step.fault_code != 0) step.code_text = odrive::fault_text(step.fault_code);
  const odrive::SetupStatus status = drive.setup_status();
  step.setup_text = status == odrive::SetupStatus::ready
                        ? "the drive is set up, stays disabled, and does not say why; ask its own tool"
                        : to_string(status);
}

}  // namespace breakaway::linux_node
