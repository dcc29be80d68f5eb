// The device of a controller node, from the objects by which it answers.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/eds/device.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/firmware/node_objects.hpp"
#include "values.hpp"

namespace breakaway::eds {
namespace {

using canopen::ObjectAddress;
using canopen::ObjectType;
using canopen::ObjectValue;
using canopen::SdoAbort;
using Flashed = config::AnyNode<float>;

// No bus: the node is asked before its first step.
struct NoPort {
  hal::SendResult send(const hal::CanFrame&, hal::Time) noexcept { return hal::SendResult::queued; }
  bool receive(hal::ReceivedFrame&) noexcept { return false; }
  void purge_transmit_queue() noexcept {}
  hal::BusState bus_state() const noexcept { return hal::BusState::error_active; }
};

// What is flashed, less kick tables and checksum: no object shows those but the serial number.
Flashed shown_node(const config::Node& node, std::uint8_t node_id) {
  Flashed shown;
  shown.loop = config::loop_config(node);
  shown.loop.network.node_id = node_id;
  shown.count = static_cast<std::uint8_t>(node.axes.size());
  for (std::size_t i = 0; i < node.axes.size(); ++i) {
    const config::Axis& axis = node.axes[i];
    shown.axes[i].drive = config::drive_config<float>(axis);
    shown.axes[i].limits = config::axis_limits<float>(axis);
    shown.axes[i].law = config::axis_parameters<float>(node, axis);
    std::ranges::copy(axis.name, shown.axes[i].name.characters.begin());
  }
  return shown;
}

// The node under an id, with its dictionary.
class AskedNode {
 public:
  AskedNode(const config::Node& node, std::uint8_t node_id)
      : flashed_{shown_node(node, node_id)}, loop_{port_, flashed_.loop}, objects_{loop_, flashed_} {
    firmware::add_axes(loop_, flashed_);
  }
  AskedNode(const AskedNode&) = delete;
  AskedNode& operator=(const AskedNode&) = delete;

  ObjectValue read(ObjectAddress address) const { return objects_.read(address); }
  // No axis is wanted, so that none of these writes is taken.
  SdoAbort refusal(ObjectAddress address, std::span<const std::uint8_t> bytes) {
    return objects_.write(address, bytes);
  }

 private:
  using Law = firmware::NodeLaws<Flashed>::Law;
  using Loop = firmware::ControlLoop<NoPort, cia402::Drive<float>, Law, float, config::most_axes>;

  NoPort port_;
  Flashed flashed_;
  Loop loop_;
  firmware::NodeObjects<Loop, Flashed> objects_;
};

DataType data_type(ObjectType type) {
  switch (type) {
    case ObjectType::text:
      return DataType::text;
    case ObjectType::u8:
      return DataType::u8;
    case ObjectType::u16:
      return DataType::u16;
    case ObjectType::u32:
      return DataType::u32;
    case ObjectType::i8:
      return DataType::i8;
    case ObjectType::i16:
      return DataType::i16;
    case ObjectType::i32:
      return DataType::i32;
    case ObjectType::r32:
      return DataType::r32;
  }
  return DataType::u32;
}

SdoAbort refusal_of_target(AskedNode& node, ObjectAddress address, std::int64_t counts) {
  std::array<std::uint8_t, 4> bytes;
  canopen::store_little_endian(bytes, static_cast<std::int32_t>(counts));
  return node.refusal(address, bytes);
}

// Returns the last number from `good` towards `bad` that is not refused with `abort`, by halving.
std::optional<std::int64_t> limit(AskedNode& node, ObjectAddress address, std::int64_t good, std::int64_t bad,
                                  SdoAbort abort) {
  if (refusal_of_target(node, address, bad) != abort) return std::nullopt;
  while (std::abs(bad - good) > 1) {
    const std::int64_t middle = (good + bad) / 2;
    (refusal_of_target(node, address, middle) == abort ? bad : good) = middle;
  }
  return good;
}

void find_limits(AskedNode& node, ObjectAddress address, Object& object) {
  constexpr std::int64_t lowest = std::numeric_limits<std::int32_t>::min();
  constexpr std::int64_t highest = std::numeric_limits<std::int32_t>::max();
  object.low = limit(node, address, highest, lowest, SdoAbort::value_too_low);
  object.high = limit(node, address, lowest, highest, SdoAbort::value_too_high);
}

// What the node goes on writing, and the serial number: it is the checksum of all that is flashed, and tells two nodes
// of one kind apart.
bool changes(ObjectAddress address) {
  if (address.index == 0x1001 || address == ObjectAddress{0x1018, 4}) return true;
  return (address.index == 0x2000 && address.subindex > 2) || (address.index > 0x2000 && address.subindex > 2);
}

std::optional<std::string> power_on_value(const ObjectValue& value, const ObjectValue& again, std::uint8_t first_id,
                                          std::uint8_t second_id) {
  const auto as_signed = [](const ObjectValue& v) { return std::int64_t{static_cast<std::int32_t>(v.number)}; };
  switch (value.type) {
    case ObjectType::text:
      return std::string{value.text};
    case ObjectType::r32:
      return fmt::format("{}", std::bit_cast<float>(value.number));
    case ObjectType::i8:
    case ObjectType::i16:
    case ObjectType::i32:
      return value_text({as_signed(value), as_signed(again), first_id, second_id, 0});
    case ObjectType::u8:
    case ObjectType::u16:
    case ObjectType::u32:
      break;
  }
  return value_text({value.number, again.number, first_id, second_id, 2 * canopen::size_bytes(value.type)});
}

// Asks every object that can be: whatever the dictionary comes to have is in the file.
std::vector<ObjectAddress> addresses(const AskedNode& node) {
  std::vector<ObjectAddress> found;
  for (unsigned index = 1; index <= 0xFFFF; ++index) {
    for (unsigned sub = 0; sub <= 0xFF; ++sub) {
      const ObjectAddress address{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)};
      const SdoAbort abort = node.read(address).abort;
      if (abort == SdoAbort::no_such_object) break;
      if (abort == SdoAbort::none) found.push_back(address);
    }
  }
  return found;
}

std::uint8_t free_id(const config::Node& node) {
  const auto taken = [&](std::uint8_t id) {
    return id == node.loop->node_id ||
           std::ranges::any_of(node.axes, [=](const config::Axis& axis) { return axis.drive->node_id == id; });
  };
  std::uint8_t id = 1;
  while (taken(id)) ++id;
  return id;
}

std::vector<unsigned> bit_rates(const config::Node& node) {
  std::vector<unsigned> fitting;
  for (const unsigned rate : bit_rates_kHz) {
    const auto fit = canopen::check_bus_budget(static_cast<unsigned>(node.axes.size()), node.loop->period, 1000 * rate);
    if (fit == canopen::BusFit::fits) fitting.push_back(rate);
  }
  return fitting;
}

std::vector<std::string> comments(const config::Node& node) {
  const std::uint8_t id = node.loop->node_id;
  return {fmt::format("Commands are taken from RPDO1 ({:X}h), and states told in TPDO1 ({:X}h), of 8 bytes each:",
                      canopen::rpdo_cob_id(1, id), canopen::tpdo_cob_id(1, id)),
          "axis u8, enable / reset / reference u8, 0 u16, target i32 in counts",
          "axis u8, fault u8, mode u8, drive state u8, position i32 in counts",
          "They are fixed, and no objects of the dictionary."};
}

}  // namespace

Device node_device(const config::Node& node) {
  config::require_flashable(node);
  const std::uint8_t first_id = node.loop->node_id, second_id = free_id(node);
  AskedNode asked{node, first_id};
  const AskedNode again{node, second_id};
  Device device{.name = std::string{asked.read({0x1008, 0}).text},
                .description = "Controller node of " + std::to_string(node.axes.size()) +
                               (node.axes.size() == 1 ? " axis with dry friction" : " axes with dry friction"),
                .vendor = asked.read({0x1018, 1}).number,
                .product = asked.read({0x1018, 2}).number,
                .revision = asked.read({0x1018, 3}).number,
                .bit_rates_kHz = bit_rates(node),
                .comments = comments(node),
                .objects = {}};
  for (const ObjectAddress address : addresses(asked)) {
    const ObjectValue value = asked.read(address);
    Object object{.index = address.index, .sub = address.subindex, .type = data_type(value.type)};
    const bool writable = asked.refusal(address, {}) != SdoAbort::read_only;
    if (writable) object.access = Access::read_write;
    if (writable) find_limits(asked, address, object);
    if (!changes(address)) object.power_on_value = power_on_value(value, again.read(address), first_id, second_id);
    device.objects.push_back(object);
  }
  return device;
}

}  // namespace breakaway::eds
