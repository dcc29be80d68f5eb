#include "breakaway/drive_emulator/drive_emulator.hpp"

#include <algorithm>
#include <chrono>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/drive_emulator/objects.hpp"

namespace breakaway::drive_emulator {

using canopen::NmtCommand;
using canopen::NmtState;
namespace object = cia402::object;

namespace {

const EmulatorConfig& validated(const EmulatorConfig& config) {
  validate(config);
  return config;
}

}  // namespace

DriveEmulator::DriveEmulator(const EmulatorConfig& config, Mechanism& mechanism, Send send)
    : config_(validated(config)),
      send_(std::move(send)),
      emergency_(dictionary_,
                 [this](const hal::CanFrame& frame) {
                   if (nmt_ != NmtState::stopped) post(frame);
                 }),
      sdo_(dictionary_),
      drive_(config_, dictionary_, emergency_, mechanism),
      random_(config.seed),
      sdo_response_delay_(config.quirks.sdo_response_delay.count() > 0 ? config.quirks.sdo_response_delay
                                                                       : config.sdo_response_delay) {
  add_communication_objects(dictionary_, config_);
  add_drive_objects(dictionary_, config_);
  // The PDOs carry what CiA 402 maps at power-on, with the torque command and the position in the third ones.
  using Mapped = std::initializer_list<Address>;
  const Mapped received[pdo_count] = {{{object::controlword, 0}},
                                      {{object::controlword, 0}, {object::mode, 0}},
                                      {{object::controlword, 0}, {object::target_torque, 0}},
                                      {}};
  const bool fits = config_.quirks.fixed_mapping == FixedMapping::fits;
  const Mapped fitting_command{{object::controlword, 0}, {object::target_torque, 0}};
  const Mapped fitting_feedback{{object::statusword, 0}, {object::position_actual, 0}, {object::torque_actual, 0}};
  const Mapped sent[pdo_count] = {{{object::statusword, 0}},
                                  {{object::statusword, 0}, {object::mode_display, 0}},
                                  {{object::statusword, 0}, {object::position_actual, 0}},
                                  {}};
  for (unsigned number = 1; number <= pdo_count; ++number) {
    const std::uint32_t absent = number > config_.valid_pdos ? canopen::cob_id_invalid : 0;
    rpdos_.emplace_back(dictionary_, PdoDirection::receive, number,
                        absent | canopen::rpdo_cob_id(number, config_.node_id),
                        fits && number == 1 ? fitting_command : received[number - 1]);
    tpdos_.emplace_back(dictionary_, PdoDirection::transmit, number,
                        absent | canopen::tpdo_cob_id(number, config_.node_id),
                        fits && number == 1 ? fitting_feedback : sent[number - 1]);
  }
  if (config_.quirks.fixed_mapping != FixedMapping::none) {
    rpdos_.front().fix_mapping();
    tpdos_.front().fix_mapping();
  }
  dictionary_.on_written([this](Address address) { on_written(address); });
}

void DriveEmulator::power_on(hal::Time time) {
  advance_to(time);
  powered_ = true;
  reset(NmtCommand::reset_node);
}

void DriveEmulator::power_off(hal::Time time) {
  advance_to(time);
  powered_ = false;
  nmt_ = NmtState::boot_up;
  timers_.cancel_all();
  outgoing_.clear();
  drive_.restart(now_);
}

void DriveEmulator::advance_to(hal::Time time) {
  for (auto due = next_event(); due && *due <= time; due = next_event()) {
    now_ = std::max(now_, *due);
    if (const auto timer = timers_.first(); timer && *timers_.due(*timer) <= now_) {
      timers_.cancel(*timer);
      on_time(*timer);
    } else {
      drive_.on_time(now_);
    }
    settle();
  }
  now_ = std::max(now_, time);
}

std::optional<hal::Time> DriveEmulator::next_event() const {
  if (!powered_) return std::nullopt;
  hal::Time next = std::min(drive_.next_event(), timers_.first_due());
  if (!outgoing_.empty()) next = std::min(next, outgoing_.begin()->first);
  return next < hal::Time::max() ? std::optional{next} : std::nullopt;
}

void DriveEmulator::advance_mechanism_to(hal::Time time) {
  advance_to(time);
  drive_.advance_mechanism_to(time);
}

double DriveEmulator::largest_force_N(hal::Time end) const { return drive_.motor().largest_force_N(hal::seconds(end)); }

void DriveEmulator::trip_fault(std::uint16_t code, hal::Time time) {
  advance_to(time);
  if (nmt_ == NmtState::boot_up) return;
  drive_.trip(code, false);
  settle();
}

void DriveEmulator::inhibit_beyond(std::optional<cia402::State> highest, hal::Time time) {
  advance_to(time);
  drive_.inhibit_beyond(highest);
  settle();
}

void DriveEmulator::limit_peak_force(double peak_force_N, hal::Time time) {
  advance_to(time);
  drive_.limit_peak_force(peak_force_N, now_);
  settle();
}

void DriveEmulator::on_time(std::size_t timer) {
  if (timer >= tpdo_event) return transmit(timer - tpdo_event);
  if (timer >= rpdo_deadline) return drive_.trip(emcy::rpdo_timeout, true);
  switch (timer) {
    case boot:
      return finish_boot();
    case heartbeat_due:
      post_heartbeat(nmt_);
      return restart_heartbeat();
    case master_heartbeat:
      return lose_master();
    case sync_alarm:
      return drive_.trip(emcy::sync_late, false);
    case sdo_timeout:
      return post({.id = canopen::sdo_response_cob_id(config_.node_id),
                   .size = 8,
                   .data = sdo_.abort(canopen::SdoAbort::timeout)});
    case information:
      emergency_.inform(config_.quirks.informs_with);
      return timers_.set(information, now_ + config_.quirks.informs_every);
  }
}

void DriveEmulator::settle() {
  const std::int64_t mode = get(object::mode_display);
  if (drive_.settle(now_)) note_event(object::statusword);
  if (mode != last_mode_display_) note_event(object::mode_display);
  last_mode_display_ = mode;
  schedule_information();
  flush();
}

void DriveEmulator::schedule_information() {
  if (config_.quirks.informs_with == 0) return;
  if (drive_.state() != cia402::State::operation_enabled) return timers_.cancel(information);
  if (!timers_.due(information)) timers_.set(information, now_);
}

void DriveEmulator::flush() {
  while (!outgoing_.empty() && outgoing_.begin()->first <= now_) {
    const hal::CanFrame frame = outgoing_.begin()->second;
    outgoing_.erase(outgoing_.begin());
    if (!silent_) send_(frame, now_);
  }
}

void DriveEmulator::post(const hal::CanFrame& frame, hal::Duration delay) { outgoing_.emplace(now_ + delay, frame); }

}  // namespace breakaway::drive_emulator
