// PowerDrive: the half of the drive that the device profile describes (CiA 402): state machine, modes, torque command,
// faults, motor and encoder.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/drive_emulator/emergency.hpp"
#include "breakaway/drive_emulator/home_seeker.hpp"
#include "breakaway/drive_emulator/mechanism.hpp"
#include "breakaway/drive_emulator/motor.hpp"
#include "breakaway/drive_emulator/object_dictionary.hpp"
#include "breakaway/drive_emulator/state_machine.hpp"
#include "breakaway/drive_emulator/timers.hpp"

namespace breakaway::drive_emulator {

class PowerDrive {
 public:
  // All arguments must outlive the drive; `dictionary` holds the drive's objects (add_drive_objects).
  PowerDrive(const EmulatorConfig& config, ObjectDictionary& dictionary, EmergencyProducer& emergency,
             Mechanism& mechanism);

  // Begins anew, as after power-on: Not ready to switch on, and no fault.
  void restart(hal::Time time);
  void self_test_passed() { machine_.self_test_passed(); }
  void on_written(std::uint16_t index, hal::Time time);
  // Nobody commands the drive any more.
  void communication_lost() { machine_.disable_voltage(); }

  // Has the drive fault with an error code (603Fh). If the cause remains, the fault cannot be reset until
  // cause_gone(code).
  void trip(std::uint16_t code, bool cause_remains);
  void cause_gone(std::uint16_t code) { causes_.erase(code); }

  // Reads encoder and torque into 6064h and 6077h, and on a SYNC the velocity since the SYNC before into 606Ch.
  void sample(hal::Time time, bool on_sync);
  // Brings torque and statusword in line with everything that was written. Returns true when the statusword changed.
  bool settle(hal::Time time);

  // Returns hal::Time::max() when nothing is to come.
  hal::Time next_event() const { return timers_.first_due(); }
  // Handles what next_event() announced. settle() must follow.
  void on_time(hal::Time time);

  void advance_mechanism_to(hal::Time time);
  // Takes the torque demand to zero, whatever the state.
  void cut_power(hal::Time time);
  // Keeps the drive from every state beyond this one that is no fault; nothing: no longer.
  void inhibit_beyond(std::optional<cia402::State> highest) { inhibited_beyond_ = highest; }
  void limit_peak_force(double peak_force_N, hal::Time time) {
    motor_.limit_peak_force(peak_force_N, hal::seconds(time));
  }

  cia402::State state() const { return machine_.state(); }
  const Motor& motor() const { return motor_; }
  void on_force_segment(std::function<void(const model::AppliedForce&)> listener) {
    segment_listener_ = std::move(listener);
  }

 private:
  enum Timer : std::size_t { stop, mode_change, silent_drop, home_step, timer_count };

  void control(std::uint16_t controlword, hal::Time time);
  std::uint16_t as_the_drive_reads_it(std::uint16_t controlword);
  void request_mode(hal::Time time);
  void clear_faults();
  bool makes_torque() const;
  double torque_demand_per_mille();
  void command_torque(double demand_per_mille, hal::Time time);
  void watch_stops(hal::Time time);
  std::uint16_t statusword() const;
  bool in_homing() const;
  void home(hal::Time time);
  void seek_home(hal::Time time);
  void end_homing(unsigned bits);
  void count_from(double home_m);
  double position_factor() const;
  bool reversed() const;
  std::int32_t in_units(std::int32_t counts) const;
  std::int32_t in_range(std::int32_t counts) const;
  std::int64_t get(std::uint16_t index) const { return dictionary_.get({index, 0}); }

  const EmulatorConfig& config_;
  ObjectDictionary& dictionary_;
  EmergencyProducer& emergency_;
  Mechanism& mechanism_;
  double force_per_per_mille_N_;
  Motor motor_;
  StateMachine machine_;
  Timers<timer_count> timers_;
  std::function<void(const model::AppliedForce&)> segment_listener_ = [](const model::AppliedForce&) {};

  std::uint16_t controlword_ = 0;  // the last one that the drive noticed
  std::optional<hal::Time> controlword_changed_;
  std::int64_t requested_mode_ = 0;
  bool enable_needs_edge_ = false;  // after a silent drop
  bool limited_ = false;            // the demand is less than what was asked for
  std::optional<cia402::State> inhibited_beyond_;
  cia402::State watched_state_ = cia402::State::not_ready_to_switch_on;
  std::set<std::uint16_t> faults_;  // tripped since the last reset
  std::set<std::uint16_t> causes_;  // of these, those whose cause is still there
  double origin_m_ = 0;             // where 6064h is 0
  HomeSeeker seeker_;
  hal::Time seeking_since_{};
  double seeking_force_N_ = 0;
  unsigned homed_ = 0;  // bits of the statusword after a homing
  std::optional<hal::Time> last_sync_;
  std::int32_t last_sync_counts_ = 0;
};

}  // namespace breakaway::drive_emulator
