#include "breakaway/watch/bus_listener.hpp"

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/overheard.hpp"

namespace breakaway::watch {

BusListener::BusListener(const config::Node& node) : node_id_{node.loop->node_id}, bus_load_{*node.bit_rate} {
  for (const config::Axis& axis : node.axes)
    axes_.push_back({.told = {.axis = node.axes.size() > 1 ? axis.name : std::string{}},
                     .position_counts = {},
                     .heard_at = {},
                     .drive_id = axis.drive->node_id,
                     .invert = axis.drive->invert_direction,
                     .resolution_m = axis.drive->encoder_resolution_m,
                     .force_quantum_N = axis.drive->force_quantum_N()});
}

std::vector<std::string> BusListener::axes() const {
  std::vector<std::string> names;
  names.reserve(axes_.size());
  for (const Axis& axis : axes_) names.push_back(axis.told.axis);
  return names;
}

void BusListener::note_target(std::size_t place, std::int32_t counts) {
  axes_[place].told.target_m = counts * axes_[place].resolution_m;
}

void BusListener::take_status(const firmware::MotionStatus& status) {
  if (status.axis >= axes_.size()) return;
  Sample& told = axes_[status.axis].told;
  told.mode = enumerator<law::Mode>(status.mode);
  told.fault = enumerator<firmware::AxisFault>(status.fault);
}

std::optional<Sample> BusListener::on_frame(const hal::ReceivedFrame& received) {
  const hal::CanFrame& frame = received.frame;
  bus_load_.add(frame, received.time);
  if (const auto status = firmware::decode_status(frame, node_id_)) {
    heard_node_at_ = received.time;
    take_status(*status);
  } else if (const auto command = firmware::decode_command(frame, node_id_)) {
    heard_commander_at_ = received.time;
    if (command->axis < axes_.size()) note_target(command->axis, command->target_counts);
  }
  for (Axis& axis : axes_) {
    if (const auto torque = cia402::overheard_command(frame, axis.drive_id, axis.invert))
      axis.told.command_N = *torque * axis.force_quantum_N;
    if (frame.id == canopen::emcy_cob_id(axis.drive_id) && frame.size == 8 && !frame.remote)
      axis.told.fault_code = canopen::load_little_endian<std::uint16_t>(frame.payload());
    const auto heard = cia402::overheard_feedback(frame, axis.drive_id, axis.invert);
    if (!heard) continue;
    axis.position_counts = heard->position_counts;
    axis.heard_at = received.time;
    axis.told.time_s = hal::seconds(received.time);
    axis.told.position_m = heard->position_counts * axis.resolution_m;
    axis.told.reported_N = heard->torque_per_mille * axis.force_quantum_N;
    axis.told.drive = heard->state;
    axis.told.bus_load = bus_load_.share(received.time);
    return axis.told;
  }
  return {};
}

}  // namespace breakaway::watch
