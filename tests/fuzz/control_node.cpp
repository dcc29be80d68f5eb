// Whatever a commander, a tool and drives say to a controller node, every torque that it sends stays within the limits
// of its axes and is zero unless the drive reported that it is enabled, and it gives at most one SDO answer a period.
#include <fuzzer/FuzzedDataProvider.h>

#include <breakaway/firmware/control_node.hpp>
#include <cmath>

#include "../unit/firmware/certified_node.hpp"
#include "../unit/firmware/listed_port.hpp"
#include "require.hpp"

namespace {

using breakaway::fuzz::require;
using breakaway::hal::CanFrame;
using breakaway::hal::Time;
namespace canopen = breakaway::canopen;
namespace cia402 = breakaway::cia402;
namespace firmware = breakaway::firmware;
namespace object = breakaway::cia402::object;

using Flashed = firmware::FlashedNode<float, 2>;
using Node = firmware::ControlNode<firmware::ListedPort, Flashed>;
constexpr std::uint8_t own_id = 0x7F;

CanFrame frame_of(std::uint16_t id, std::uint8_t size, std::uint64_t payload) {
  CanFrame frame{.id = id, .size = size, .remote = false, .data = {}};
  canopen::store_little_endian(frame.data, payload);
  return frame;
}

// What a usable drive answers to a read.
std::uint32_t proper_value(std::uint16_t index, std::uint8_t subindex) {
  switch (index) {
    case object::device_type:
      return cia402::device_profile;
    case object::supported_modes:
      return cia402::supports_cyclic_torque;
    case object::mode_display:
      return static_cast<std::uint32_t>(cia402::Mode::cyclic_torque);
    case object::statusword:
      return 0x0240;
    case object::sync_cob_id:
      return canopen::sync_cob_id;
    case object::rated_torque:
      return 500;
    case object::max_torque:
      return 2000;
    default:
      return subindex == 0 ? 0 : 1;
  }
}

// A drive whose set-up goes as it should, so that an axis gets as far as Operation enabled within one input.
struct Drive {
  std::uint8_t id;
  std::uint64_t status = 0x0240;
  std::int32_t position = 0;
  bool operational = false;
  std::array<std::uint64_t, 8> written{};

  void obey(const CanFrame& frame, firmware::ListedPort& port, Time now) {
    if (frame.id == canopen::nmt_cob_id && frame.data[0] == 1 && (frame.data[1] == 0 || frame.data[1] == id))
      operational = true;
    if (frame.id == canopen::sdo_request_cob_id(id)) answer(frame, port, now);
    if (frame.id == canopen::rpdo_cob_id(1, id)) follow(canopen::load_little_endian<std::uint16_t>(frame.data, 0));
  }
  // One state at a time, as the profile has it.
  void follow(std::uint16_t controlword) {
    switch (controlword & 0x8FU) {
      case 0x0FU:
        if (status == 0x0223) status = 0x0227;
        if (status == 0x0221) status = 0x0223;
        break;
      case 0x07U:
        status = 0x0223;
        break;
      case 0x06U:
        status = 0x0221;
        break;
      default:
        status = 0x0240;
    }
  }
  void answer(const CanFrame& request, firmware::ListedPort& port, Time now) {
    const bool read = request.data[0] == 0x40;
    const auto index = canopen::load_little_endian<std::uint16_t>(request.data, 1);
    auto& kept = written[(index + request.data[3]) % 8];
    CanFrame response = request;
    response.id = canopen::sdo_response_cob_id(id);
    response.data[0] = read ? 0x43 : 0x60;
    if (!read)
      kept = std::uint64_t{index} << 40U | std::uint64_t{request.data[3]} << 32U |
             canopen::load_little_endian<std::uint32_t>(request.data, 4);
    const bool known = kept >> 32U == (std::uint64_t{index} << 8U | request.data[3]);
    std::uint32_t value = 0;
    if (read) value = known ? static_cast<std::uint32_t>(kept) : proper_value(index, request.data[3]);
    canopen::store_little_endian(response.data, value, 4);
    port.inbox.push_back({response, now});
  }
  void speak(firmware::ListedPort& port, Time now) const {
    port.inbox.push_back({frame_of(canopen::heartbeat_cob_id(id), 1, operational ? 5 : 127), now});
    const std::uint64_t sample = status | std::uint64_t{static_cast<std::uint32_t>(position)} << 16U;
    if (operational) port.inbox.push_back({frame_of(canopen::tpdo_cob_id(1, id), 8, sample), now});
  }
};

// Of an object that is there, or nearly: no payload of eight random bytes would name one.
CanFrame any_request(FuzzedDataProvider& input) {
  CanFrame frame = frame_of(canopen::sdo_request_cob_id(own_id), 8, 0);
  frame.data[0] = input.PickValueInArray<std::uint8_t>({0x40, 0x60, 0x70, 0x22, 0x23, 0x2B, 0x2F, 0x80});
  const auto index = input.PickValueInArray<std::uint16_t>(
      {0x1000, 0x1001, 0x1008, 0x1017, 0x1018, 0x1200, 0x2000, 0x2101, 0x2102, 0x2103, 0x2108});
  canopen::store_little_endian(frame.data, index, 1);
  frame.data[3] = input.ConsumeIntegralInRange<std::uint8_t>(0, 0x12);
  const std::int32_t value =
      input.ConsumeBool() ? input.ConsumeIntegral<std::int16_t>() : input.ConsumeIntegral<std::int32_t>();
  canopen::store_little_endian(frame.data, value, 4);
  return frame;
}

CanFrame any_frame(FuzzedDataProvider& input) {
  const auto payload = input.ConsumeIntegral<std::uint64_t>();
  const std::uint8_t drive = input.ConsumeBool() ? 1 : 2;
  switch (input.ConsumeIntegralInRange(0, 7)) {
    case 0:
      return frame_of(canopen::rpdo_cob_id(1, own_id), 8, payload);
    case 1:
      return frame_of(canopen::sdo_request_cob_id(own_id), 8, payload);
    case 2:
      return frame_of(canopen::tpdo_cob_id(1, drive), 8, payload);
    case 3:
      return frame_of(canopen::emcy_cob_id(drive), 8, payload);
    case 4:
      return frame_of(canopen::heartbeat_cob_id(drive), 1, payload);
    case 5:
      return frame_of(canopen::sdo_response_cob_id(drive), 8, payload);
    case 6:
      return any_request(input);
    default:
      return frame_of(input.ConsumeIntegralInRange<std::uint16_t>(0, 0x7FF),
                      input.ConsumeIntegralInRange<std::uint8_t>(0, 8), payload);
  }
}

void check_command(const CanFrame& frame, const Flashed& flashed, const Node& node, std::size_t place) {
  const auto torque = static_cast<std::int16_t>(canopen::load_little_endian<std::uint16_t>(frame.data, 2));
  if (torque == 0) return;
  const auto axis = node.loop().axis(place);
  require(axis && node.loop().status(*axis).feedback.state == breakaway::hal::DriveState::enabled);
  const auto& rating = node.loop().drive(*axis).rating();
  const double force_N = torque * 1e-6 * rating.rated_torque_mNm * flashed.axes[place].drive.force_per_torque_N_per_Nm;
  require(std::fabs(force_N) <= flashed.axes[place].law.max_force_N * 1.000001);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  static const Flashed flashed = firmware::testing::certified_node();
  FuzzedDataProvider input(bytes, count);
  firmware::ListedPort port;
  Node node{port, flashed};
  require(node.verdict().ok());
  std::array<Drive, 2> drives{Drive{.id = 1}, Drive{.id = 2}};
  const auto period = flashed.loop.network.period;
  Time now{};
  const auto step = [&] {
    now += period;
    for (const Drive& drive : drives) drive.speak(port, now);
    port.sent.clear();
    port.deadlines.clear();
    node.step(now);
    int answers = 0;
    for (const CanFrame& frame : port.sent) {
      answers += frame.id == canopen::sdo_response_cob_id(own_id) ? 1 : 0;
      for (std::size_t i = 0; i < drives.size(); ++i)
        if (frame.id == canopen::rpdo_cob_id(1, drives[i].id)) check_command(frame, flashed, node, i);
      for (Drive& drive : drives) drive.obey(frame, port, now);
    }
    require(answers <= 1);
  };
  while (input.remaining_bytes() > 0) {
    const unsigned choice = input.ConsumeIntegral<std::uint8_t>();
    for (unsigned i = 0; i < (choice & 7U); ++i) step();
    if ((choice & 8U) != 0) {
      const auto axis = static_cast<std::uint8_t>((choice >> 4U) & 1U);
      const firmware::MotionCommand command{.axis = axis,
                                            .enable = (choice & 0x20U) != 0,
                                            .reset_fault = (choice & 0x40U) != 0,
                                            .reference = (choice & 0x80U) != 0,
                                            .target_counts = input.ConsumeIntegral<std::int16_t>()};
      port.inbox.push_back({firmware::encode_command(command, own_id), now});
    } else if ((choice & 0x10U) != 0) {
      drives[(choice >> 5U) & 1U].position += input.ConsumeIntegral<std::int8_t>();
    } else if ((choice & 0x20U) != 0) {
      port.inbox.push_back({any_frame(input), now});
    }
    step();
  }
  return 0;
}
