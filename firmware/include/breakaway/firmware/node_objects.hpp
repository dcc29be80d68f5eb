// NodeObjects: what a controller node shows of itself as CANopen objects, for any tool that reads by SDO.
//
//   1000h, 1001h, 1008h, 1017h, 1018h, 1200h   as CiA 301 has them; a bit of the error register says that an axis has a
//                                              fault, and the serial number is the checksum of the flashed node
//   2000h   the node        :01 axes, :02 period in ns, :03 steps, :04 missed ticks, :05 shortest and :06 longest
//                           interval between two steps in ns, :07 frames that the port did not take
//   2101h   the first axis, 2102h the second ...: the sub-indices of AxisEntry
//
// Counters are modulo 2^32, an interval that is longer than 2^32 - 1 ns is shown as that, and what is no number in SI
// units is an integer or text.
//
// The target of an axis may be written, everything else is read-only. It is taken by the rules of a command
// (remote_control.hpp): only while the axis is wanted, which begins with the rising edge of a commander's "enable" and
// ends with its silence, and until the commander sends another target or enables the axis anew. Otherwise it is refused
// with 0800'0022h, and beyond the limits of position with 0609'0031h or 0609'0032h.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/object_address.hpp"
#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/canopen/sdo_server.hpp"
#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::firmware {

namespace internal {

constexpr canopen::ObjectValue refused(canopen::SdoAbort abort) noexcept {
  return {.abort = abort, .type = canopen::ObjectType::text, .number = 0, .text = {}};
}
constexpr canopen::ObjectValue shown_text(std::string_view text) noexcept {
  return {.abort = canopen::SdoAbort::none, .type = canopen::ObjectType::text, .number = 0, .text = text};
}
template <class Integer>
consteval canopen::ObjectType integer_type() noexcept {
  using enum canopen::ObjectType;
  static_assert(sizeof(Integer) == 1 || sizeof(Integer) == 2 || sizeof(Integer) == 4);
  constexpr bool is_signed = std::is_signed_v<Integer>;
  if (sizeof(Integer) == 1) return is_signed ? i8 : u8;
  if (sizeof(Integer) == 2) return is_signed ? i16 : u16;
  return is_signed ? i32 : u32;
}
template <class Integer>
constexpr canopen::ObjectValue shown(Integer value) noexcept {
  return {.abort = canopen::SdoAbort::none,
          .type = integer_type<Integer>(),
          .number = static_cast<std::uint32_t>(value),
          .text = {}};
}
template <class Scalar>
constexpr canopen::ObjectValue shown_real(Scalar value) noexcept {
  return {.abort = canopen::SdoAbort::none,
          .type = canopen::ObjectType::r32,
          .number = std::bit_cast<std::uint32_t>(static_cast<float>(value)),
          .text = {}};
}
constexpr canopen::ObjectValue shown_ns(hal::Duration duration) noexcept {
  constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();
  return shown(static_cast<std::uint32_t>(std::clamp<std::int64_t>(duration.count(), 0, most)));
}

}  // namespace internal

// Sub-indices of an axis' object.
enum class AxisEntry : std::uint8_t {
  count = 0x00,             // u8, the largest sub-index
  name = 0x01,              // text
  target = 0x02,            // i32, counts; may be written
  position = 0x03,          // i32, counts
  position_m = 0x04,        // r32, m
  commanded_force = 0x05,   // r32, N
  reported_force = 0x06,    // r32, N; by the drive
  mode = 0x07,              // u8, law::Mode
  drive_state = 0x08,       // u8, hal::DriveState
  fault = 0x09,             // u8, AxisFault
  fault_name = 0x0A,        // text
  fault_code = 0x0B,        // u16, error code of the drive that came with the fault
  stop_not_obeyed = 0x0C,   // u8, since the last reset
  statusword = 0x0D,        // u16, of the drive
  setup_status = 0x0E,      // u8, cia402::SetupStatus
  setup_object = 0x0F,      // u32, the object at which the set-up stands: index and sub-index, as 603F00h
  newest_emergency = 0x10,  // u16, code of the drive's newest EMCY, also of one that is information only
};

// Loop: a ControlLoop of cia402 drives. Node: the FlashedNode that it was made from. Both must outlive this.
template <class Loop, class Node>
class NodeObjects {
 public:
  static constexpr std::uint16_t node_index = 0x2000, first_axis_index = 0x2101, most_axes = 8;

  NodeObjects(Loop& loop, const Node& node) noexcept : loop_{&loop}, node_{&node} {}

  // They are called now and then: their size counts.
  [[gnu::cold]] canopen::ObjectValue read(canopen::ObjectAddress address) const noexcept {
    if (address.index >= first_axis_index && address.index < first_axis_index + most_axes) return read_axis(address);
    return address.index == node_index ? read_node(address.subindex) : read_standard(address);
  }

  [[gnu::cold]] canopen::SdoAbort write(canopen::ObjectAddress address, std::span<const std::uint8_t> bytes) noexcept {
    const canopen::ObjectValue present = read(address);
    if (present.abort != canopen::SdoAbort::none) return present.abort;
    const bool is_target =
        address.index >= first_axis_index && address.subindex == static_cast<std::uint8_t>(AxisEntry::target);
    if (!is_target) return canopen::SdoAbort::read_only;
    if (bytes.size() != canopen::size_bytes(present.type)) return canopen::SdoAbort::length_mismatch;
    return write_target(*loop_->axis(address.index - std::size_t{first_axis_index}),
                        canopen::load_little_endian<std::int32_t>(bytes));
  }

 private:
  using AxisId = typename Loop::AxisId;

  [[gnu::cold]] canopen::SdoAbort write_target(AxisId id, std::int32_t counts) noexcept {
    const auto& limits = node_->axes[id.index()].limits;
    const auto target_m =
        static_cast<decltype(limits.position_max_m)>(counts) * loop_->drive(id).encoder_resolution_m();
    if (target_m > limits.position_max_m) return canopen::SdoAbort::value_too_high;
    if (target_m < limits.position_min_m) return canopen::SdoAbort::value_too_low;
    if (!loop_->is_wanted(id)) return canopen::SdoAbort::device_state;
    loop_->set_target_counts(id, counts);
    return canopen::SdoAbort::none;
  }

  [[gnu::cold]] canopen::ObjectValue read_axis(canopen::ObjectAddress address) const noexcept {
    const auto axis = loop_->axis(address.index - std::size_t{first_axis_index});
    if (!axis) return internal::refused(canopen::SdoAbort::no_such_object);
    const auto& status = loop_->status(*axis);
    const auto& drive = loop_->drive(*axis);
    switch (static_cast<AxisEntry>(address.subindex)) {
      case AxisEntry::count:
        return internal::shown(static_cast<std::uint8_t>(AxisEntry::newest_emergency));
      case AxisEntry::name:
        return internal::shown_text(node_->axes[axis->index()].name.view());
      case AxisEntry::target:
        return internal::shown(loop_->target_counts(*axis));
      case AxisEntry::position:
        return internal::shown(drive.position_counts());
      case AxisEntry::position_m:
        return internal::shown_real(status.feedback.position_m);
      case AxisEntry::commanded_force:
        return internal::shown_real(status.output.force_N);
      case AxisEntry::reported_force:
        return internal::shown_real(status.feedback.force_N);
      case AxisEntry::mode:
        return internal::shown(static_cast<std::uint8_t>(status.output.mode));
      case AxisEntry::drive_state:
        return internal::shown(static_cast<std::uint8_t>(status.feedback.state));
      case AxisEntry::fault:
        return internal::shown(static_cast<std::uint8_t>(status.fault));
      case AxisEntry::fault_name:
        return internal::shown_text(to_string(status.fault));
      case AxisEntry::fault_code:
        return internal::shown(loop_->supervisor(*axis).fault_code());
      case AxisEntry::stop_not_obeyed:
        return internal::shown(static_cast<std::uint8_t>(status.stop_not_obeyed));
      case AxisEntry::statusword:
        return internal::shown(drive.statusword());
      case AxisEntry::setup_status:
        return internal::shown(static_cast<std::uint8_t>(drive.setup_status()));
      case AxisEntry::setup_object:
        return internal::shown(std::uint32_t{drive.setup_object().index} << 8U | drive.setup_object().subindex);
      case AxisEntry::newest_emergency:
        return internal::shown(drive.last_emcy().code);
    }
    return internal::refused(canopen::SdoAbort::no_such_subindex);
  }

  [[gnu::cold]] canopen::ObjectValue read_node(std::uint8_t subindex) const noexcept {
    const auto& statistics = loop_->statistics();
    switch (subindex) {
      case 0:
        return internal::shown(std::uint8_t{7});
      case 1:
        return internal::shown(static_cast<std::uint8_t>(loop_->axes()));
      case 2:
        return internal::shown_ns(node_->loop.network.period);
      case 3:
        return internal::shown(static_cast<std::uint32_t>(statistics.ticks()));
      case 4:
        return internal::shown(static_cast<std::uint32_t>(statistics.missed_ticks()));
      case 5:
        return internal::shown_ns(statistics.shortest_interval());
      case 6:
        return internal::shown_ns(statistics.longest_interval());
      case 7:
        return internal::shown(static_cast<std::uint32_t>(loop_->refused_frames()));
      default:
        return internal::refused(canopen::SdoAbort::no_such_subindex);
    }
  }

  [[gnu::cold]] canopen::ObjectValue read_standard(canopen::ObjectAddress address) const noexcept {
    const auto& network = node_->loop.network;
    switch (address.index) {
      case 0x1000:  // no profile of CiA
        return only(address, internal::shown(std::uint32_t{0}));
      case 0x1001:
        return only(address, internal::shown(static_cast<std::uint8_t>(any_fault() ? 1 : 0)));
      case 0x1008:
        return only(address, internal::shown_text("breakaway"));
      case 0x1017: {
        const auto period = std::chrono::duration_cast<std::chrono::milliseconds>(network.heartbeat_period);
        return only(address, internal::shown(static_cast<std::uint16_t>(period.count())));
      }
      case 0x1018: {
        const std::array<std::uint32_t, 4> identity{0, 0, 0, node_->checksum};
        return of_list(address, identity);
      }
      case 0x1200: {
        const std::array<std::uint32_t, 2> server{canopen::sdo_request_cob_id(network.node_id),
                                                  canopen::sdo_response_cob_id(network.node_id)};
        return of_list(address, server);
      }
      default:
        return internal::refused(canopen::SdoAbort::no_such_object);
    }
  }

  static canopen::ObjectValue only(canopen::ObjectAddress address, canopen::ObjectValue value) noexcept {
    return address.subindex == 0 ? value : internal::refused(canopen::SdoAbort::no_such_subindex);
  }
  static canopen::ObjectValue of_list(canopen::ObjectAddress address, std::span<const std::uint32_t> values) noexcept {
    if (address.subindex == 0) return internal::shown(static_cast<std::uint8_t>(values.size()));
    return address.subindex <= values.size() ? internal::shown(values[address.subindex - 1U])
                                             : internal::refused(canopen::SdoAbort::no_such_subindex);
  }

  bool any_fault() const noexcept {
    for (std::size_t i = 0; i < loop_->axes(); ++i) {
      if (loop_->status(*loop_->axis(i)).fault != AxisFault::none) return true;
    }
    return false;
  }

  Loop* loop_;
  const Node* node_;
};

}  // namespace breakaway::firmware
