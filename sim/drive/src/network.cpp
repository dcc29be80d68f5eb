// The communication half of the drive emulator: NMT, heartbeat, SDO, SYNC and PDOs (CiA 301).
#include <algorithm>
#include <chrono>
#include <utility>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/drive_emulator/objects.hpp"

namespace breakaway::drive_emulator {

using canopen::NmtCommand;
using canopen::NmtState;
namespace object = cia402::object;

namespace {

hal::Duration milliseconds(std::int64_t count) { return std::chrono::milliseconds{count}; }

hal::CanFrame frame_of(std::uint16_t id, const ObjectDictionary::Bytes& data) {
  hal::CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(data.size())};
  std::ranges::copy(data, frame.data.begin());
  return frame;
}

}  // namespace

void DriveEmulator::on_frame(const hal::CanFrame& frame, hal::Time time) {
  advance_to(time);
  if (silent_ || frame.remote || nmt_ == NmtState::boot_up) return;
  dispatch(frame);
  settle();
  advance_to(now_);  // what became due at once
}

void DriveEmulator::dispatch(const hal::CanFrame& frame) {
  if (frame.id == canopen::nmt_cob_id) return on_nmt(frame);
  if (frame.id == master_heartbeat_id()) return on_master_heartbeat();
  if (nmt_ == NmtState::stopped) return;
  if (frame.id == (get(object::sync_cob_id) & 0x7FF)) return on_sync(frame);
  if (frame.id == canopen::sdo_request_cob_id(config_.node_id)) return on_sdo(frame);
  for (std::size_t number = 0; operational() && number < pdo_count; ++number)
    if (rpdos_[number].valid() && rpdos_[number].can_id() == frame.id) on_rpdo(number, frame);
}

void DriveEmulator::on_written(Address address) {
  if (address.index == own_object::error_history)
    for (std::uint8_t sub = 1; dictionary_.find({own_object::error_history, sub}) != nullptr; ++sub)
      dictionary_.set({own_object::error_history, sub}, 0);
  if (address.index == object::producer_heartbeat) restart_heartbeat();
  if (address.index == object::consumer_heartbeat) {
    timers_.cancel(master_heartbeat);
    drive_.cause_gone(emcy::heartbeat);
  }
  for (std::size_t number = 0; number < pdo_count; ++number) {
    if (address.index == rpdos_[number].parameter_index()) {
      latched_[number].reset();
      timers_.cancel(rpdo_deadline + number);
    }
    if (address.index == tpdos_[number].parameter_index()) {
      tpdo_states_[number] = {};
      timers_.cancel(tpdo_event + number);
      schedule_event(number);
    }
  }
  drive_.on_written(address.index, now_);
}

// ---- NMT ----

void DriveEmulator::on_nmt(const hal::CanFrame& frame) {
  if (frame.size != 2 || (frame.data[1] != canopen::all_nodes && frame.data[1] != config_.node_id)) return;
  switch (static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::start:
      if (config_.quirks.refuses_start_with != 0) return emergency_.raise(config_.quirks.refuses_start_with);
      return enter(NmtState::operational);
    case NmtCommand::stop:
      return enter(NmtState::stopped);
    case NmtCommand::enter_pre_operational:
      return enter(NmtState::pre_operational);
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      return reset(static_cast<NmtCommand>(frame.data[0]));
  }
}

void DriveEmulator::enter(NmtState state) {
  if (state == nmt_) return;
  if (operational()) drive_.communication_lost();
  nmt_ = state;
  const bool locked = config_.quirks.maps_in_pre_operational_only && operational();
  for (Pdo& pdo : rpdos_) pdo.lock(locked);
  for (Pdo& pdo : tpdos_) pdo.lock(locked);
  latched_ = {};
  tpdo_states_ = {};
  timers_.cancel(sync_alarm);
  for (std::size_t number = 0; number < pdo_count; ++number) {
    timers_.cancel(rpdo_deadline + number);
    timers_.cancel(tpdo_event + number);
    schedule_event(number);
  }
  if (state == NmtState::stopped) {
    sdo_.reset();
    timers_.cancel(sdo_timeout);
  }
}

void DriveEmulator::reset(NmtCommand command) {
  enter(NmtState::boot_up);
  timers_.cancel_all();
  outgoing_.clear();
  sdo_.reset();
  if (command == NmtCommand::reset_node) {
    emergency_.reset();
    drive_.restart(now_);
    dictionary_.restore_power_on_values(0x2000, 0xFFFF);
  }
  const std::int64_t error_register = emergency_.any() ? get(object::error_register) : 0;
  dictionary_.restore_power_on_values(0x1000, 0x1FFF);
  dictionary_.set({object::error_register, 0}, error_register);
  last_sync_.reset();
  timers_.set(boot, now_ + config_.boot_duration);
}

void DriveEmulator::finish_boot() {
  sdo_ready_ = now_ + config_.quirks.sdo_busy;
  drive_.self_test_passed();
  if (!config_.quirks.no_boot_up_message) post_heartbeat(NmtState::boot_up);
  enter(NmtState::pre_operational);
  if (config_.quirks.self_starting) enter(NmtState::operational);
  restart_heartbeat();
}

// ---- heartbeat ----

void DriveEmulator::post_heartbeat(NmtState state) {
  if (heartbeat_suppressed_) return;
  post({.id = canopen::heartbeat_cob_id(config_.node_id), .size = 1, .data = {static_cast<std::uint8_t>(state)}});
}

void DriveEmulator::restart_heartbeat() {
  timers_.cancel(heartbeat_due);
  if (const std::int64_t period_ms = get(object::producer_heartbeat); period_ms > 0)
    timers_.set(heartbeat_due, now_ + milliseconds(period_ms));
}

std::optional<std::uint16_t> DriveEmulator::master_heartbeat_id() const {
  const std::int64_t consumer = get(object::consumer_heartbeat, 1);
  const auto node = static_cast<std::uint8_t>(consumer >> 16);
  if (node == 0 || (consumer & 0xFFFF) == 0) return std::nullopt;
  return canopen::heartbeat_cob_id(node);
}

void DriveEmulator::on_master_heartbeat() {
  drive_.cause_gone(emcy::heartbeat);
  timers_.set(master_heartbeat, now_ + milliseconds(get(object::consumer_heartbeat, 1) & 0xFFFF));
}

void DriveEmulator::lose_master() {
  drive_.trip(emcy::heartbeat, true);
  if (!operational() || get(own_object::error_behaviour, 1) == 1) return;
  enter(get(own_object::error_behaviour, 1) == 0 ? NmtState::pre_operational : NmtState::stopped);
}

// ---- SDO ----

void DriveEmulator::on_sdo(const hal::CanFrame& frame) {
  if (frame.size != 8) return;
  drive_.sample(now_, false);
  const bool busy = now_ < sdo_ready_;
  const bool refused =
      std::ranges::find(config_.quirks.refused_objects, canopen::load_little_endian<std::uint16_t>(frame.data, 1)) !=
      config_.quirks.refused_objects.end();
  const auto code =
      busy ? canopen::SdoAbort::device_state : static_cast<canopen::SdoAbort>(config_.quirks.refusal_code);
  if (const auto answer = busy || refused ? sdo_.refuse(frame.data, code) : sdo_.answer(frame.data))
    post({.id = canopen::sdo_response_cob_id(config_.node_id), .size = 8, .data = *answer}, sdo_response_delay_);
  timers_.cancel(sdo_timeout);
  if (sdo_.transfer_under_way()) timers_.set(sdo_timeout, now_ + config_.sdo_timeout);
}

// ---- SYNC and PDO ----

void DriveEmulator::on_sync(const hal::CanFrame& frame) {
  if (frame.size != 0) return emergency_.raise(emcy::sync_length);
  emergency_.clear(emcy::sync_length);
  last_sync_ = now_;
  drive_.sample(now_, true);
  if (!operational()) return;
  restart_sync_alarm();
  for (std::size_t number = 0; number < pdo_count; ++number)
    if (const auto command = std::exchange(latched_[number], std::nullopt)) rpdos_[number].unpack(command->payload());
  settle();
  send_synchronous_tpdos();
}

void DriveEmulator::restart_sync_alarm() {
  const std::int64_t period_us = get(object::sync_period);
  if (config_.quirks.sync_alarm_periods == 0 || period_us == 0) return;
  const std::int64_t periods = 1 + std::int64_t{config_.quirks.sync_alarm_periods};
  timers_.set(sync_alarm, now_ + std::chrono::microseconds{periods * period_us});
}

bool DriveEmulator::inside_sync_window() const {
  const std::int64_t window_us = get(object::sync_window);
  return window_us == 0 || !last_sync_ || now_ - *last_sync_ <= std::chrono::microseconds{window_us};
}

void DriveEmulator::on_rpdo(std::size_t number, const hal::CanFrame& frame) {
  Pdo& rpdo = rpdos_[number];
  if (frame.size < rpdo.size_bytes()) return emergency_.raise(emcy::pdo_too_short);
  if (frame.size > rpdo.size_bytes())
    emergency_.raise(emcy::pdo_too_long);  // the standard has the bytes that are mapped used all the same
  else
    emergency_.clear(emcy::pdo_too_long);
  emergency_.clear(emcy::pdo_too_short);
  drive_.cause_gone(emcy::rpdo_timeout);
  if (rpdo.event_time_ms() > 0) timers_.set(rpdo_deadline + number, now_ + milliseconds(rpdo.event_time_ms()));
  if (!rpdo.synchronous()) return rpdo.unpack(frame.payload());
  if (inside_sync_window()) latched_[number] = frame;
}

void DriveEmulator::send_synchronous_tpdos() {
  for (std::size_t number = 0; number < pdo_count; ++number) {
    TpdoState& state = tpdo_states_[number];
    if (!tpdos_[number].valid() || !tpdos_[number].synchronous()) continue;
    const unsigned type = tpdos_[number].transmission_type();
    if (type == 0 ? state.event : ++state.syncs >= type) transmit(number);
  }
}

// The profile makes changes of statusword and mode the events of event-driven TPDOs.
void DriveEmulator::note_event(std::uint16_t index) {
  for (std::size_t number = 0; number < pdo_count; ++number)
    if (tpdos_[number].maps(index)) schedule_event(number);
}

void DriveEmulator::schedule_event(std::size_t number) {
  const Pdo& tpdo = tpdos_[number];
  if (!operational() || !tpdo.valid()) return;
  TpdoState& state = tpdo_states_[number];
  state.event = true;
  if (tpdo.synchronous()) return;
  const hal::Duration inhibit = std::chrono::microseconds{100 * tpdo.inhibit_time_100us()};
  timers_.set(tpdo_event + number, state.sent ? std::max(now_, *state.sent + inhibit) : now_);
}

void DriveEmulator::transmit(std::size_t number) {
  const Pdo& tpdo = tpdos_[number];
  tpdo_states_[number] = {.sent = now_};
  if (!tpdo.synchronous()) {
    drive_.sample(now_, false);
    if (tpdo.event_time_ms() > 0) timers_.set(tpdo_event + number, now_ + milliseconds(tpdo.event_time_ms()));
  }
  if (tpdo.size_bytes() > 0) post(frame_of(tpdo.can_id(), tpdo.pack()), tpdo_delay());
}

hal::Duration DriveEmulator::tpdo_delay() {
  const auto span = static_cast<std::uint64_t>((config_.max_tpdo_delay - config_.min_tpdo_delay).count());
  return config_.min_tpdo_delay + hal::Duration{static_cast<std::int64_t>(random_() % (span + 1))};
}

}  // namespace breakaway::drive_emulator
