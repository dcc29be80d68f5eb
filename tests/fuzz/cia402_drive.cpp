// Whatever a node on the bus says of itself, the force that it is told to make stays within the axis' limit and its
// own, and is zero unless the drive reported that it is enabled.
#include <fuzzer/FuzzedDataProvider.h>
#include <breakaway/cia402/drive.hpp>
#include <cmath>

#include "require.hpp"

namespace {

using breakaway::fuzz::require;
using breakaway::hal::CanFrame;
using breakaway::hal::DriveState;
using breakaway::hal::Time;
namespace canopen = breakaway::canopen;
namespace cia402 = breakaway::cia402;
namespace object = breakaway::cia402::object;

constexpr cia402::DriveConfig<float> config{
    .node_id = 5, .force_per_torque_N_per_Nm = 50, .emcy_information = {.first = {0xFF00}, .last = {0xFFFF}}};
constexpr breakaway::hal::NetworkConfig network{.period = std::chrono::milliseconds{1}};
constexpr breakaway::hal::AxisScale<float> scale{.encoder_resolution_m = 1e-6F, .max_force_N = 50};
static_assert(cia402::check(config, network, scale) == cia402::DriveConfigError::none);

CanFrame frame_of(std::uint16_t id, std::uint8_t size, std::uint64_t payload) {
  CanFrame frame{.id = id, .size = size, .remote = false, .data = {}};
  canopen::store_little_endian(frame.data, payload);
  return frame;
}

// What a usable drive answers, so that some inputs get through the set-up; any number where none is wrong.
std::uint32_t proper_value(FuzzedDataProvider& input, std::uint16_t index) {
  switch (index) {
    case object::device_type:
      return cia402::device_profile;
    case object::supported_modes:
      return cia402::supports_cyclic_torque;
    case object::mode_display:
      return static_cast<std::uint32_t>(cia402::Mode::cyclic_torque);
    case object::statusword:
      return input.ConsumeProbability<float>() < 0.9F ? 0x0240 : input.ConsumeIntegral<std::uint16_t>();
    case object::sync_cob_id:
      return canopen::sync_cob_id;
    case object::torque_offset:
    case object::quick_stop_option:
    case object::shutdown_option:
    case object::disable_option:
    case object::fault_reaction_option:
      return input.ConsumeProbability<float>() < 0.99F ? 0 : 2;
    case object::rated_torque:
      return input.ConsumeBool() ? 500 : input.ConsumeIntegral<std::uint32_t>();
    default:
      return input.ConsumeIntegral<std::uint32_t>();
  }
}

CanFrame proper_answer(FuzzedDataProvider& input, const CanFrame& request) {
  const auto index = canopen::load_little_endian<std::uint16_t>(request.data, 1);
  const bool read = request.data[0] == 0x40;
  CanFrame answer = request;
  answer.id = canopen::sdo_response_cob_id(config.node_id);
  answer.data[0] = read ? 0x43 : 0x60;
  canopen::store_little_endian(answer.data, read ? proper_value(input, index) : 0, 4);
  return answer;
}

CanFrame any_frame(FuzzedDataProvider& input) {
  constexpr auto id = config.node_id;
  const auto payload = input.ConsumeIntegral<std::uint64_t>();
  switch (input.ConsumeIntegralInRange(0, 4)) {
    case 0:
      return frame_of(canopen::emcy_cob_id(id), 8, payload);
    case 1:
      return frame_of(canopen::heartbeat_cob_id(id), 1, payload);
    case 2:
      return frame_of(canopen::sdo_response_cob_id(id), 8, payload);
    case 3:
      return frame_of(canopen::tpdo_cob_id(1, id), 8, payload);
    default:
      return frame_of(input.ConsumeIntegral<std::uint16_t>(), input.ConsumeIntegral<std::uint8_t>(), payload);
  }
}

// The statusword of a state that a drive on its way to Operation enabled passes through, or any.
std::uint64_t statusword(FuzzedDataProvider& input) {
  constexpr std::array<std::uint16_t, 5> common{0x0240, 0x0221, 0x0223, 0x0227, 0x0008};
  const auto choice = input.ConsumeIntegralInRange<std::size_t>(0, 2 * common.size());
  return choice < common.size() ? common[choice]
                                : (choice == common.size() ? input.ConsumeIntegral<std::uint16_t>() : common[3]);
}

bool is_start(const CanFrame& frame) {
  return frame.id == canopen::nmt_cob_id && frame.data[0] == static_cast<std::uint8_t>(canopen::NmtCommand::start);
}

void check_command(const CanFrame& frame, const cia402::Drive<float>& drive, DriveState state) {
  const auto torque = static_cast<std::int16_t>(canopen::load_little_endian<std::uint16_t>(frame.data, 2));
  if (torque == 0) return;
  require(state == DriveState::enabled);
  require(std::abs(static_cast<int>(torque)) <= drive.rating().max_torque_per_mille);
  const double force_N = torque * 1e-6 * drive.rating().rated_torque_mNm * config.force_per_torque_N_per_Nm;
  require(std::fabs(force_N) <= scale.max_force_N * 1.000001);  // to the rounding of the quantum in float
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  FuzzedDataProvider input(bytes, count);
  cia402::Drive<float> drive(config, network, scale);
  canopen::NmtState node = canopen::NmtState::pre_operational;
  drive.request_enable();
  for (Time now{}; input.remaining_bytes() > 0; now += network.period) {
    CanFrame frame;
    // A drive that is forced to a stop is asked for its state without end: a set-up has fewer objects.
    for (int asked = 0; asked < 64 && drive.next_acyclic_frame(frame, now); ++asked) {
      if (is_start(frame)) node = canopen::NmtState::operational;
      if (frame.id != canopen::sdo_request_cob_id(config.node_id)) continue;
      drive.on_frame({proper_answer(input, frame), now});
      drive.update(now);  // asks for the next object: a set-up of one object a round would use up the input
    }
    drive.on_frame({frame_of(canopen::heartbeat_cob_id(config.node_id), 1, static_cast<std::uint8_t>(node)), now});
    const std::uint64_t sample = statusword(input) | input.ConsumeIntegral<std::uint64_t>() << 16U;
    drive.on_frame({frame_of(canopen::tpdo_cob_id(1, config.node_id), 8, sample), now});
    if (input.ConsumeProbability<float>() > 0.9F) drive.on_frame({any_frame(input), now});

    drive.update(now);
    require(!config.emcy_information.hold(drive.take_emergency()));
    const auto feedback = drive.feedback();
    require(std::isfinite(feedback.position_m) && std::isfinite(feedback.force_N));
    drive.command(input.ConsumeFloatingPoint<float>());
    if (drive.next_command_frame(frame)) check_command(frame, drive, feedback.state);
  }
  return 0;
}
