// The far end of the wire for the tests of cia402::Drive: a node that answers as a drive does, with nothing behind it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/heartbeat.hpp"
#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/canopen/sync.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::test {

class ScriptedDrive {
 public:
  explicit ScriptedDrive(std::uint8_t node_id) : node_{node_id} {}

  std::map<std::uint32_t, std::uint32_t> objects{
      {key(0x1000, 0), 0x00020192}, {key(0x6502, 0), 1U << 9}, {key(0x6075, 0), 5000},  {key(0x6076, 0), 1000},
      {key(0x6072, 0), 2000},       {key(0x6061, 0), 10},      {key(0x603F, 0), 0x2310}};
  std::map<std::uint32_t, canopen::SdoAbort> refused;  // writes and reads of these abort
  std::map<std::uint32_t, std::uint32_t> kept;         // writes of these are taken and forgotten
  std::map<std::uint32_t, std::uint32_t> most;         // writes of more to these abort
  std::set<std::uint32_t> read_only;                   // writes of these abort
  std::vector<std::uint32_t> written;                  // keys, in order
  std::vector<canopen::NmtCommand> commands;
  std::vector<hal::CanFrame> out;  // what it sends
  bool silent = false;
  canopen::NmtState nmt = canopen::NmtState::boot_up;
  cia402::State state = cia402::State::switch_on_disabled;
  bool follows_controlword = true;  // of the RPDO
  unsigned sdo_requests_lost = 0;   // so many more are not heard
  bool boots_silently = false;      // says no boot-up
  bool saves_its_heartbeat = false;
  bool ignores_start = false;  // stays in Pre-operational
  bool sends_tpdo = true;
  bool follows_sdo_controlword = true;    // written to 6040h
  bool stops_in_pre_operational = false;  // by itself
  bool shows_the_mode_at_once = false;    // 6061h follows 6060h; otherwise it is what stands in `objects`
  std::uint16_t extra_status = 0;         // bits of the statusword in the TPDO beside those of the state
  std::int32_t counts = 0;
  std::int16_t torque = 0;
  std::uint16_t controlword = 0;
  std::int16_t target = 0;
  unsigned rpdos = 0;

  static constexpr std::uint32_t key(std::uint16_t index, std::uint8_t subindex) {
    return static_cast<std::uint32_t>(index) << 8 | subindex;
  }

  void boot() {
    objects[key(0x1016, 1)] = 0;
    if (!saves_its_heartbeat) objects[key(0x1017, 0)] = 0;
    state = cia402::State::switch_on_disabled;
    if (!boots_silently) send(canopen::heartbeat_frame(canopen::NmtState::boot_up, node_));
    nmt = canopen::NmtState::pre_operational;
  }
  void heartbeat() { send(canopen::heartbeat_frame(nmt, node_)); }
  void emergency(std::uint16_t code) { send(canopen::emcy_frame({.code = code}, node_)); }

  void on_frame(const hal::CanFrame& frame) {
    if (silent) return;
    if (frame.id == canopen::nmt_cob_id && frame.data[1] == node_)
      on_nmt(static_cast<canopen::NmtCommand>(frame.data[0]));
    if (frame.id == canopen::sdo_request_cob_id(node_)) on_sdo(frame);
    if (nmt != canopen::NmtState::operational) return;
    if (frame.id == canopen::rpdo_cob_id(1, node_) && is_valid(0x1400)) on_rpdo(frame);
    if (frame.id == value_of(0x1005, 0).value_or(0x80) && is_valid(0x1800) && sends_tpdo) send_tpdo();
  }
  std::optional<std::uint32_t> value_of(std::uint16_t index, std::uint8_t subindex) const {
    const auto found = objects.find(key(index, subindex));
    return found == objects.end() ? std::nullopt : std::optional{found->second};
  }
  // Heartbeats at the period that was written to it.
  void advance_to(hal::Time now) {
    const auto period = std::chrono::milliseconds{objects[key(0x1017, 0)]};
    if (period.count() == 0 || now < last_heartbeat_ + period) return;
    last_heartbeat_ = now;
    heartbeat();
  }

 private:
  bool is_valid(std::uint16_t pdo) const { return (value_of(pdo, 1).value_or(0) & canopen::cob_id_invalid) == 0; }
  void send(const hal::CanFrame& frame) {
    if (!silent) out.push_back(frame);
  }
  void on_nmt(canopen::NmtCommand command) {
    commands.push_back(command);
    if (command == canopen::NmtCommand::start && !ignores_start) nmt = canopen::NmtState::operational;
    if (command == canopen::NmtCommand::enter_pre_operational) {
      nmt = canopen::NmtState::pre_operational;
      if (stops_in_pre_operational) state = cia402::State::switch_on_disabled;
    }
    if (command == canopen::NmtCommand::reset_communication || command == canopen::NmtCommand::reset_node) boot();
  }
  void on_sdo(const hal::CanFrame& frame) {
    if (frame.data[0] == 0x80) return;  // the client ends a transfer
    if (sdo_requests_lost > 0) {
      --sdo_requests_lost;
      return;
    }
    const auto index = canopen::load_little_endian<std::uint16_t>(frame.data, 1);
    const std::uint32_t object = key(index, frame.data[3]);
    const bool read = frame.data[0] == 0x40;
    hal::CanFrame answer{.id = canopen::sdo_response_cob_id(node_), .size = 8, .data = frame.data};
    std::optional<canopen::SdoAbort> error;
    if (refused.contains(object)) error = refused[object];
    objects[key(0x6041, 0)] = cia402::status_bits(state);
    objects[key(0x6077, 0)] = static_cast<std::uint16_t>(torque);
    if (kept.contains(object)) objects[object] = kept[object];
    if (!read && read_only.contains(object)) error = canopen::SdoAbort::read_only;
    if (!read && most.contains(object) && canopen::load_little_endian<std::uint32_t>(frame.data, 4) > most[object])
      error = canopen::SdoAbort::value_too_high;
    if (read && !objects.contains(object)) error = canopen::SdoAbort::no_such_object;
    if (error) {
      answer.data[0] = 0x80;
      canopen::store_little_endian(answer.data, static_cast<std::uint32_t>(*error), 4);
    } else if (read) {
      answer.data[0] = 0x43;
      canopen::store_little_endian(answer.data, objects[object], 4);
    } else {
      objects[object] = canopen::load_little_endian<std::uint32_t>(frame.data, 4);
      if (kept.contains(object)) objects[object] = kept[object];
      written.push_back(object);
      if (object == key(0x6060, 0) && shows_the_mode_at_once) objects[key(0x6061, 0)] = objects[object];
      if (object == key(0x6040, 0) && follows_sdo_controlword) follow(static_cast<std::uint16_t>(objects[object]));
      answer.data = {0x60, frame.data[1], frame.data[2], frame.data[3]};
    }
    send(answer);
  }
  void on_rpdo(const hal::CanFrame& frame) {
    ++rpdos;
    target = canopen::load_little_endian<std::int16_t>(frame.data, 2);
    const auto received = canopen::load_little_endian<std::uint16_t>(frame.data, 0);
    if (follows_controlword)
      follow(received);
    else
      controlword = received;
  }
  void follow(std::uint16_t received) {
    const bool reset_edge = (received & 0x80U) != 0 && (controlword & 0x80U) == 0;
    controlword = received;
    state = next_state(reset_edge);
  }
  cia402::State next_state(bool reset_edge) const {
    using cia402::State;
    if (state == State::fault) return reset_edge ? State::switch_on_disabled : state;
    if ((controlword & 0x02) == 0) return State::switch_on_disabled;
    if ((controlword & 0x06) == 0x02)
      return state == State::operation_enabled ? State::quick_stop_active : State::switch_on_disabled;
    switch (state) {
      case State::switch_on_disabled:
        return (controlword & 0x07) == 0x06 ? State::ready_to_switch_on : state;
      case State::ready_to_switch_on:
        return (controlword & 0x07) == 0x07 ? State::switched_on : state;
      case State::switched_on:
        return (controlword & 0x0F) == 0x0F ? State::operation_enabled : state;
      default:
        return state;
    }
  }
  void send_tpdo() {
    hal::CanFrame frame{.id = canopen::tpdo_cob_id(1, node_), .size = 8, .data = {}};
    canopen::store_little_endian(frame.data,
                                 static_cast<std::uint16_t>(cia402::status_bits(state) | 0x0210U | extra_status), 0);
    canopen::store_little_endian(frame.data, counts, 2);
    canopen::store_little_endian(frame.data, torque, 6);
    send(frame);
  }

  std::uint8_t node_;
  hal::Time last_heartbeat_{};
};

}  // namespace breakaway::test
