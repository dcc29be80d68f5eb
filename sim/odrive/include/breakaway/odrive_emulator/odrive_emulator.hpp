// OdriveEmulator: an ODrive with firmware 0.6 as a node of CANSimple in simulated time, with a motor and an encoder on
// a mechanism.
//
// It is written from the protocol's description and shares only the numbers of messages with the project's own side. A
// command acts when its frame has come. Estimates and torques are sampled as they are sent, by the drive's own clock,
// or when they are asked for. A watchdog, fed by Set_Input_Torque, disarms an axis that is no longer commanded.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>

#include "breakaway/drive_emulator/emulated_drive.hpp"
#include "breakaway/drive_emulator/mechanism.hpp"
#include "breakaway/drive_emulator/motor.hpp"
#include "breakaway/drive_emulator/timers.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/odrive_emulator/config.hpp"

namespace breakaway::odrive_emulator {

class OdriveEmulator final : public drive_emulator::EmulatedDrive {
 public:
  // Called with each frame that the drive puts into its transmit queue, and when. It must not call the drive.
  using Send = std::function<void(const hal::CanFrame&, hal::Time)>;

  // The drive is powered off at first. `mechanism` must outlive it.
  OdriveEmulator(const EmulatorConfig& config, drive_emulator::Mechanism& mechanism, Send send);
  OdriveEmulator(const OdriveEmulator&) = delete;
  OdriveEmulator& operator=(const OdriveEmulator&) = delete;

  // It is heard after boot_duration.
  void power_on(hal::Time time) override;
  void power_off(hal::Time time) override;
  void on_frame(const hal::CanFrame& frame, hal::Time time) override;
  void advance_to(hal::Time time) override;
  std::optional<hal::Time> next_event() const override;
  void advance_mechanism_to(hal::Time time) override;
  const model::AppliedForce& force() const override { return motor_.segment(); }
  double largest_force_N(hal::Time end) const override { return motor_.largest_force_N(hal::seconds(end)); }

  // Has the drive disarm with these error bits; their cause is momentary.
  void trip(std::uint32_t errors, hal::Time time);
  // The power stage goes off, and the drive says nothing of why.
  void disarm_silently(hal::Time time);
  void set_silent(bool silent) { silent_ = silent; }
  void suppress_heartbeat(bool suppressed) { heartbeat_suppressed_ = suppressed; }
  void suppress_estimates(bool suppressed) { estimates_suppressed_ = suppressed; }
  void suppress_torques(bool suppressed) { torques_suppressed_ = suppressed; }
  void ignore_idle(bool ignored) { config_.ignores_idle = ignored; }
  void ignore_estop(bool ignored) { config_.ignores_estop = ignored; }
  // These bits take the place of what it would show; nothing: no longer.
  void show_position(std::optional<float> turns) { shown_turns_ = turns; }
  void show_torque(std::optional<float> torque_Nm) { shown_torque_Nm_ = torque_Nm; }

  odrive::AxisState state() const { return state_; }
  std::uint32_t errors() const { return errors_; }
  double torque_limit_Nm() const;

 private:
  enum Timer : std::size_t { boot, heartbeat_due, estimate_due, torque_due, watchdog, timer_count };

  void on_time(std::size_t timer);
  void restart();
  void start();
  void obey(const hal::CanFrame& frame);
  void answer(odrive::Command command);
  void request_state(odrive::AxisState asked);
  void disarm(std::uint32_t errors);
  void feed_watchdog();
  void settle();
  void again(Timer timer, hal::Duration period);
  void post(const hal::CanFrame& frame, hal::Duration delay = {});
  void flush();
  hal::CanFrame heartbeat() const;
  hal::CanFrame estimates();
  hal::CanFrame torques();

  EmulatorConfig config_;
  drive_emulator::Mechanism& mechanism_;
  Send send_;
  drive_emulator::Motor motor_;
  drive_emulator::Timers<timer_count> timers_;
  std::multimap<hal::Time, hal::CanFrame> outgoing_;

  hal::Time now_{};
  odrive::AxisState state_ = odrive::AxisState::undefined;
  std::uint32_t errors_ = 0;
  std::uint8_t result_ = 0;
  std::uint32_t control_mode_ = 3;  // position, as a drive comes
  double input_torque_Nm_ = 0;
  std::optional<double> current_limit_A_;
  double origin_m_ = 0;
  double sampled_m_ = 0;
  hal::Time sampled_at_{};
  bool running_ = false;  // has booted
  bool silent_ = false, heartbeat_suppressed_ = false, estimates_suppressed_ = false, torques_suppressed_ = false;
  std::optional<float> shown_turns_, shown_torque_Nm_;
};

}  // namespace breakaway::odrive_emulator
