#include "breakaway/drive_emulator/power_drive.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace breakaway::drive_emulator {

using cia402::State;
namespace object = cia402::object;
namespace status_bit = cia402::status_bit;

namespace {

constexpr std::int64_t mode_changing = -1;
constexpr std::uint16_t enable_operation_bit = 0x08;

// Returns the nearest value that an i16 object can hold.
std::int64_t saturate_i16(double value) {
  return static_cast<std::int64_t>(std::clamp(std::round(value), -32768.0, 32767.0));
}

double force_per_per_mille(const EmulatorConfig& config) {
  return config.rated_torque_mNm * 1e-6 * config.force_per_torque_N_per_Nm;
}

}  // namespace

PowerDrive::PowerDrive(const EmulatorConfig& config, ObjectDictionary& dictionary, EmergencyProducer& emergency,
                       Mechanism& mechanism)
    : config_(config),
      dictionary_(dictionary),
      emergency_(emergency),
      mechanism_(mechanism),
      force_per_per_mille_N_(force_per_per_mille(config)),
      motor_(config.peak_force_N.value_or(config.max_torque_per_mille * force_per_per_mille_N_),
             config.current_loop_time_constant_s) {}

void PowerDrive::restart(hal::Time time) {
  machine_ = {};
  watched_state_ = machine_.state();
  timers_.cancel_all();
  controlword_ = 0;
  requested_mode_ = 0;
  controlword_changed_.reset();
  enable_needs_edge_ = limited_ = false;
  end_homing(0);
  faults_.clear();
  causes_.clear();
  last_sync_.reset();
  if (config_.quirks.silent_drop_at && *config_.quirks.silent_drop_at >= time)
    timers_.set(silent_drop, *config_.quirks.silent_drop_at);
  cut_power(time);
  if (config_.quirks.counts_from_power_on) origin_m_ = mechanism_.position_m();
}

void PowerDrive::on_written(std::uint16_t index, hal::Time time) {
  if (index == object::controlword) control(static_cast<std::uint16_t>(get(index)), time);
  if (index == object::mode) request_mode(time);
}

void PowerDrive::control(std::uint16_t controlword, hal::Time time) {
  if (controlword != controlword_) {
    const bool too_soon =
        controlword_changed_ && time - *controlword_changed_ < config_.quirks.min_controlword_interval;
    if (too_soon) return;
    controlword_changed_ = time;
    const bool starts = (controlword & ~controlword_ & cia402::control::start_homing) != 0;
    controlword_ = controlword;
    if (starts && in_homing()) home(time);
  }
  const bool was_fault = machine_.state() == State::fault;
  machine_.control(as_the_drive_reads_it(controlword), causes_.empty(), get(object::quick_stop_option));
  if (was_fault && machine_.state() != State::fault) clear_faults();
}

std::uint16_t PowerDrive::as_the_drive_reads_it(std::uint16_t controlword) {
  if ((controlword & enable_operation_bit) == 0) enable_needs_edge_ = false;
  const bool no_mode = config_.quirks.needs_mode_to_enable && get(object::mode) == 0;
  if (!enable_needs_edge_ && !no_mode) return controlword;
  return static_cast<std::uint16_t>(controlword & ~unsigned{enable_operation_bit});
}

void PowerDrive::request_mode(hal::Time time) {
  if (get(object::mode) == requested_mode_) return;  // it was asked for again, as by a cyclic RPDO
  requested_mode_ = get(object::mode);
  if (config_.quirks.mode_display_delay.count() == 0) {
    dictionary_.set({object::mode_display, 0}, get(object::mode));
    return;
  }
  dictionary_.set({object::mode_display, 0}, mode_changing);
  timers_.set(mode_change, time + config_.quirks.mode_display_delay);
}

void PowerDrive::trip(std::uint16_t code, bool cause_remains) {
  faults_.insert(code);
  if (cause_remains) causes_.insert(code);
  dictionary_.set({object::error_code, 0}, code);
  emergency_.raise(code);
  machine_.trip();
}

void PowerDrive::clear_faults() {
  for (const std::uint16_t code : faults_) emergency_.clear(code);
  faults_.clear();
  dictionary_.set({object::error_code, 0}, 0);
}

void PowerDrive::advance_mechanism_to(hal::Time time) { mechanism_.advance_to(hal::seconds(time), motor_.segment()); }

bool PowerDrive::reversed() const { return (get(object::polarity) & 0x80) != 0; }

bool PowerDrive::in_homing() const {
  return machine_.state() == State::operation_enabled &&
         get(object::mode_display) == static_cast<std::int64_t>(cia402::Mode::homing);
}

void PowerDrive::home(hal::Time time) {
  if (config_.quirks.homing_fails) return end_homing(status_bit::homing_error);
  const std::int64_t method = get(object::homing_method);
  if (config_.quirks.switches && HomeSeeker::knows(method)) {
    const auto in_metres = [&](Address address) {
      return static_cast<double>(dictionary_.get(address)) / position_factor() * config_.encoder_resolution_m;
    };
    end_homing(0);
    seeker_.start(*config_.quirks.switches, method,
                  {in_metres({object::homing_speeds, 1}), in_metres({object::homing_speeds, 2}),
                   in_metres({object::homing_acceleration, 0})},
                  mechanism_.position_m());
    seeking_since_ = time;
    return timers_.set(home_step, time + HomeSeeker::period);
  }
  count_from(mechanism_.position_m());
  end_homing(status_bit::homing_attained | status_bit::target_reached);
}

// A homing that is interrupted has found nothing.
void PowerDrive::seek_home(hal::Time time) {
  if (!in_homing() || (controlword_ & cia402::control::halt) != 0) return end_homing(0);
  const Quirks& quirks = config_.quirks;
  if (quirks.homing_gives_up_after.count() > 0 && time - seeking_since_ > quirks.homing_gives_up_after)
    return end_homing(status_bit::homing_error);
  advance_mechanism_to(time);
  const bool knew = seeker_.home_m().has_value();
  seeking_force_N_ =
      seeker_.step(mechanism_.position_m(), static_cast<double>(get(object::max_torque)) * force_per_per_mille_N_);
  if (seeker_.home_m() && !knew) count_from(*seeker_.home_m());
  if (seeker_.arrived()) return end_homing(status_bit::homing_attained | status_bit::target_reached);
  timers_.set(home_step, time + HomeSeeker::period);
}

void PowerDrive::end_homing(unsigned bits) {
  homed_ = bits;
  seeking_force_N_ = 0;
  seeker_.end();
  timers_.cancel(home_step);
}

// The position is the offset there.
void PowerDrive::count_from(double home_m) {
  const double offset_counts = static_cast<double>(get(object::home_offset)) / position_factor();
  origin_m_ = home_m - (reversed() ? -1 : 1) * offset_counts * config_.encoder_resolution_m;
}

double PowerDrive::position_factor() const {
  const auto ratio = [this](std::uint16_t index) {
    return static_cast<double>(dictionary_.get({index, 1})) / static_cast<double>(dictionary_.get({index, 2}));
  };
  return ratio(object::feed_constant) / ratio(object::encoder_resolution) / ratio(object::gear_ratio);
}

std::int32_t PowerDrive::in_units(std::int32_t counts) const {
  const double factor = position_factor();
  return factor == 1 ? counts : static_cast<std::int32_t>(std::llround(std::remainder(counts * factor, 0x1p32)));
}

std::int32_t PowerDrive::in_range(std::int32_t counts) const {
  const std::int64_t low = dictionary_.get({object::position_range, 1});
  const std::int64_t range = dictionary_.get({object::position_range, 2}) - low + 1;
  if (range <= 1) return counts;
  return static_cast<std::int32_t>(low + ((counts - low) % range + range) % range);
}

void PowerDrive::sample(hal::Time time, bool on_sync) {
  advance_mechanism_to(time);
  const std::int32_t counts = in_range(in_units(
      encoder_counts((reversed() ? -1 : 1) * (mechanism_.position_m() - origin_m_), config_.encoder_resolution_m)));
  dictionary_.set({object::position_actual, 0}, counts);
  dictionary_.set({object::torque_actual, 0},
                  saturate_i16(motor_.force_at_N(hal::seconds(time)) / force_per_per_mille_N_));
  if (!on_sync) return;
  if (last_sync_ && time > *last_sync_) {
    // The subtraction is unsigned, because the counter may have wrapped around between the two.
    const auto moved =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(counts) - static_cast<std::uint32_t>(last_sync_counts_));
    const double velocity = std::round(moved / hal::seconds(time - *last_sync_));
    dictionary_.set({object::velocity_actual, 0},
                    static_cast<std::int64_t>(std::clamp(velocity, -2147483648.0, 2147483647.0)));
  }
  last_sync_ = time;
  last_sync_counts_ = counts;
}

bool PowerDrive::makes_torque() const {
  const bool halted = (controlword_ & cia402::control::halt) != 0;
  return machine_.state() == State::operation_enabled && !halted &&
         get(object::mode_display) == static_cast<std::int64_t>(cia402::Mode::cyclic_torque);
}

double PowerDrive::torque_demand_per_mille() {
  limited_ = false;
  if (seeker_.seeking() && in_homing()) return seeking_force_N_ / force_per_per_mille_N_;
  if (!makes_torque()) return 0;
  const auto max_per_mille = static_cast<double>(get(object::max_torque));
  auto asked = static_cast<double>(get(object::target_torque));
  if (config_.quirks.torque_relative_to_max) asked *= max_per_mille / 1000;
  asked += static_cast<double>(get(object::torque_offset));
  const double peak_per_mille = motor_.peak_force_N() / force_per_per_mille_N_;
  const double limit = std::min(max_per_mille, peak_per_mille);
  limited_ = std::abs(asked) > limit;
  return std::clamp(asked, -limit, limit);
}

void PowerDrive::command_torque(double demand_per_mille, hal::Time time) {
  dictionary_.set({object::torque_demand, 0}, saturate_i16(demand_per_mille));
  const double force_N = motor_.clamped(demand_per_mille * force_per_per_mille_N_);
  if (force_N == motor_.commanded_N()) return;
  advance_mechanism_to(time);
  motor_.command(force_N, hal::seconds(time));
  mechanism_.change_force(motor_.segment());
  segment_listener_(motor_.segment());
}

void PowerDrive::cut_power(hal::Time time) { command_torque(0, time); }

void PowerDrive::watch_stops(hal::Time time) {
  if (machine_.state() == watched_state_) return;
  watched_state_ = machine_.state();
  if (watched_state_ == State::quick_stop_active || watched_state_ == State::fault_reaction_active)
    timers_.set(stop, time + config_.stop_duration);
  else
    timers_.cancel(stop);
}

std::uint16_t PowerDrive::statusword() const {
  unsigned word = cia402::status_bits(machine_.state());
  if (machine_.state() != State::not_ready_to_switch_on) word |= status_bit::voltage_enabled | status_bit::remote;
  if (emergency_.any() && faults_.empty()) word |= status_bit::warning;
  if (limited_) word |= status_bit::internal_limit;
  if (makes_torque()) word |= status_bit::follows_target;
  if (get(object::mode_display) == static_cast<std::int64_t>(cia402::Mode::homing)) word |= homed_;
  return static_cast<std::uint16_t>(word);
}

bool PowerDrive::settle(hal::Time time) {
  if (inhibited_beyond_) machine_.fall_back_to(*inhibited_beyond_);
  watch_stops(time);
  command_torque(torque_demand_per_mille(), time);
  const std::int64_t word = statusword();
  const bool changed = word != get(object::statusword);
  dictionary_.set({object::statusword, 0}, word);
  return changed;
}

void PowerDrive::on_time(hal::Time time) {
  for (auto first = timers_.first(); first && *timers_.due(*first) <= time; first = timers_.first()) {
    timers_.cancel(*first);
    switch (*first) {
      case stop:
        machine_.stop_finished(get(object::quick_stop_option));
        break;
      case mode_change:
        dictionary_.set({object::mode_display, 0}, get(object::mode));
        break;
      case silent_drop:
        enable_needs_edge_ = machine_.state() == State::operation_enabled;
        machine_.fall_back_to(State::switched_on);
        break;
      case home_step:
        seek_home(time);
        break;
    }
  }
}

}  // namespace breakaway::drive_emulator
