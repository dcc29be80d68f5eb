// Whatever a node on the bus says of itself in CANSimple, the torque that it is told to make stays within the axis'
// limit and the motor's, and is none unless the drive is enabled; whoever takes it for faulty says why in a sentence.
#include <fuzzer/FuzzedDataProvider.h>
#include <breakaway/hal/can_port.hpp>
#include <breakaway/odrive/drive.hpp>
#include <cmath>
#include <cstring>
#include <string_view>

#include "require.hpp"

namespace {

using breakaway::fuzz::require;
using breakaway::fuzz::require_one_line;
using breakaway::hal::CanFrame;
using breakaway::hal::DriveState;
using breakaway::hal::Time;
namespace odrive = breakaway::odrive;
using odrive::Command;

constexpr breakaway::hal::NetworkConfig network{.period = std::chrono::milliseconds{1}};
constexpr breakaway::hal::AxisScale<float> scale{.encoder_resolution_m = 1e-6F, .max_force_N = 40};

odrive::DriveConfig<float> any_config(FuzzedDataProvider& input) {
  odrive::DriveConfig<float> config{
      .node_id = 5, .force_per_torque_N_per_Nm = 50, .max_torque_Nm = 1, .counts_per_turn = 125664};
  config.estimates = input.ConsumeBool() ? odrive::Estimates::polled : odrive::Estimates::cyclic;
  config.invert_direction = input.ConsumeBool();
  config.absolute_encoder = input.ConsumeBool();
  if (input.ConsumeBool()) config.velocity_limit_turns_s = 10, config.current_limit_A = 20;
  require(odrive::check(config, network, scale) == odrive::DriveConfigError::none);
  return config;
}

// A number as a drive may show it, or any bits.
float any_float(FuzzedDataProvider& input) {
  if (input.ConsumeProbability<float>() < 0.95F) return input.ConsumeFloatingPointInRange<float>(-2, 2);
  const auto bits = input.ConsumeIntegral<std::uint32_t>();
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// The message that a drive in this state would send now.
CanFrame message(FuzzedDataProvider& input, std::uint8_t node, Command command, odrive::AxisState state) {
  switch (command) {
    case Command::heartbeat: {
      const bool as_it_is = input.ConsumeProbability<float>() < 0.95F;
      const auto errors = as_it_is ? 0U : input.ConsumeIntegral<std::uint32_t>();
      const auto shown = as_it_is ? static_cast<std::uint32_t>(state) : input.ConsumeIntegral<std::uint32_t>();
      return odrive::frame_of(node, command, errors, shown);
    }
    case Command::get_version: {
      CanFrame frame = odrive::frame_of(node, command, input.ConsumeIntegral<std::uint32_t>(), std::uint32_t{0});
      if (input.ConsumeProbability<float>() < 0.95F) frame.data = {2, 4, 4, 0, 0, 6, 9, 0};
      return frame;
    }
    case Command::get_encoder_estimates:
    case Command::get_torques:
      return odrive::frame_of(node, command, any_float(input), any_float(input));
    default:
      return odrive::frame_of(node, command, input.ConsumeIntegral<std::uint32_t>(),
                              input.ConsumeIntegral<std::uint32_t>());
  }
}

CanFrame any_frame(FuzzedDataProvider& input) {
  CanFrame frame{.id = input.ConsumeIntegral<std::uint16_t>(),
                 .size = input.ConsumeIntegral<std::uint8_t>(),
                 .remote = input.ConsumeBool(),
                 .data = {}};
  if (input.ConsumeBool()) frame.id = odrive::identifier(5, odrive::command_of(frame.id));
  for (auto& byte : frame.data) byte = input.ConsumeIntegral<std::uint8_t>();
  return frame;
}

// What the drive makes of what it is told.
class Node {
 public:
  explicit Node(odrive::Drive<float>& drive) : drive_{drive} {}

  void obey(const CanFrame& frame, FuzzedDataProvider& input, Time now) {
    require(breakaway::hal::is_sendable(frame) && odrive::node_id_of(frame.id) == 5);
    const Command command = odrive::command_of(frame.id);
    if (frame.remote) return drive_.on_frame({message(input, 5, command, state_), now});
    if (command == Command::estop) state_ = odrive::AxisState::idle;
    if (command != Command::set_axis_state || input.ConsumeProbability<float>() > 0.95F) return;
    state_ = static_cast<odrive::AxisState>(frame.data[0]);
  }
  void tell(FuzzedDataProvider& input, Time now) {
    for (const Command command : {Command::heartbeat, Command::get_encoder_estimates, Command::get_torques})
      if (input.ConsumeProbability<float>() < 0.9F) drive_.on_frame({message(input, 5, command, state_), now});
    if (input.ConsumeProbability<float>() > 0.9F) drive_.on_frame({any_frame(input), now});
  }

 private:
  odrive::Drive<float>& drive_;
  odrive::AxisState state_ = odrive::AxisState::idle;
};

void check_torque(const CanFrame& frame, DriveState state) {
  require(odrive::command_of(frame.id) == Command::set_input_torque && !frame.remote && frame.size == 8);
  const float torque_Nm = odrive::load_float(frame, 0);
  require(std::isfinite(torque_Nm) && odrive::load(frame, 4) == 0);
  if (torque_Nm == 0) return;
  require(state == DriveState::enabled);
  require(std::fabs(torque_Nm) <= 1 && std::fabs(torque_Nm) * 50 <= scale.max_force_N * 1.000001F);
}

void check_sentences(const odrive::Drive<float>& drive, DriveState state) {
  require_one_line(to_string(drive.setup_status()));
  if (state == DriveState::fault) require(drive.last_error_code() != 0);
  const std::string_view text = odrive::Drive<float>::fault_text(drive.last_error_code());
  require_one_line(text);
  require(text != "unknown error");
}

void command_anything(odrive::Drive<float>& drive, FuzzedDataProvider& input) {
  drive.command(any_float(input) * 100);
  switch (input.ConsumeIntegralInRange(0, 40)) {
    case 0:
      return drive.request_stop();
    case 1:
      return drive.reset_fault();
    case 2:
      return drive.set_reference_counts(input.ConsumeIntegral<std::int32_t>());
    case 3:
      return drive.set_datum_counts(input.ConsumeIntegral<std::int32_t>());
    default:
      return drive.request_enable();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  FuzzedDataProvider input(bytes, count);
  odrive::Drive<float> drive(any_config(input), network, scale);
  require(drive.setup_status() != odrive::SetupStatus::config_invalid);
  Node node{drive};
  // A period is skipped now and then, so that what waits for a time comes to it.
  for (Time now{}; input.remaining_bytes() > 0;
       now += network.period * (input.ConsumeProbability<float>() < 0.9F ? 1 : input.ConsumeIntegralInRange(2, 400))) {
    node.tell(input, now);
    drive.update(now);
    const auto feedback = drive.feedback();
    require(std::isfinite(feedback.position_m) && std::isfinite(feedback.position_offset_m) &&
            std::isfinite(feedback.travel_m) && std::isfinite(feedback.force_N));
    check_sentences(drive, feedback.state);
    command_anything(drive, input);
    CanFrame frame;
    if (drive.next_command_frame(frame)) check_torque(frame, feedback.state);
    int questions = 0;
    for (; drive.next_poll_frame(frame); ++questions) node.obey(frame, input, now);
    require(questions <= 2);
    if (drive.next_acyclic_frame(frame, now)) node.obey(frame, input, now);
  }
  return 0;
}
