#include "canopen_side.hpp"

#include <fmt/format.h>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/master.hpp"
#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/canopen/sync.hpp"
#include "error_text.hpp"

namespace breakaway::linux_node {
namespace {

std::string object_text(canopen::ObjectAddress object) {
  return fmt::format("{:04X}h:{:02X}", object.index, object.subindex);
}

}  // namespace

std::optional<std::uint8_t> CanopenSide::heard_node(const hal::CanFrame& frame) {
  const std::uint8_t node = canopen::node_id_of(frame.id);
  if (frame.id != canopen::sdo_response_cob_id(node) && frame.id != canopen::heartbeat_cob_id(node)) return {};
  return node;
}

// Two masters would double the SYNC rate and fight over every drive. One is heard by its SYNC, by the heartbeat of our
// own node id, or by what it tells our drives.
std::string CanopenSide::other_master(const hal::CanFrame& frame, const hal::NetworkConfig& network,
                                      std::span<const std::uint8_t> nodes) {
  if (canopen::is_sync(frame)) return "it sends SYNC";
  if (frame.id == canopen::heartbeat_cob_id(network.node_id))
    return fmt::format("it is node {}, as we are", network.node_id);
  for (const std::uint8_t node : nodes) {
    if (canopen::Master::is_command(frame, node)) return fmt::format("it commands node {}", node);
  }
  return {};
}

std::string CanopenSide::why_unusable(const Drive& drive) {
  const cia402::SetupStatus status = drive.setup_status();
  switch (status) {
    case cia402::SetupStatus::object_refused:
      return fmt::format("{} ({}: {})", to_string(status), object_text(drive.setup_object()),
                         canopen::to_string(drive.setup_abort_code()));
    case cia402::SetupStatus::value_not_kept:
      return fmt::format("{} ({})", to_string(status), object_text(drive.setup_object()));
    case cia402::SetupStatus::rated_torque_differs:
    case cia402::SetupStatus::rated_torque_unit:
      return fmt::format("{} (6076h is {})", to_string(status), drive.rating().rated_torque_mNm);
    default:
      return std::string{to_string(status)};
  }
}

std::string CanopenSide::why_standing(const Drive& drive) {
  if (const canopen::Emcy& told = drive.last_error(); told.code != 0)
    return fmt::format("it does not get ready, and tells why: {}; see its manual",
                       error_text(told.code, told.error_register));
  return fmt::format("the set-up stands still at object {} ({}); check the wiring", object_text(drive.setup_object()),
                     to_string(drive.setup_status()));
}

void CanopenSide::note(const Drive& drive, StepRecord& step) {
  step.error_register = drive.last_error().error_register;
  step.statusword = drive.statusword();
}

// A node that is killed cannot put 6072h back, and the next one takes what it finds for the drive's own.
std::string CanopenSide::last_words(const Drive& drive, const AxisPlan& plan) {
  const cia402::DriveRating& rating = drive.rating();
  const std::uint16_t found = rating.found_max_torque_per_mille;
  if (found == 0 || found > rating.max_torque_per_mille || found >= plan.max_torque_per_mille) return {};
  return fmt::format(
      "            torque limit (6072h) was found at {} per mille, and the file says {}: a node that was killed may "
      "have left it so; switch the drive off and on, or write 6072h\n",
      found, plan.max_torque_per_mille);
}

}  // namespace breakaway::linux_node
