// DriveNode: the CANSimple side of one drive. It sets the drive up, enables and stops it, watches its heartbeats and
// errors, and knows nothing of newtons and metres.
//
// Set-up. The heartbeat is waited for, then the version is asked for, the power stage is taken off if somebody left it
// on, and Set_Controller_Mode (torque, passthrough) and Set_Limits are sent; nothing acknowledges them. The drive is
// ready when its estimates come.
//
// A stop. Set_Axis_State(IDLE) is sent every retell_time until a heartbeat shows a state without torque, and the
// reports of torque show none. If that takes longer than a stop may, Estop is sent in turn with it, and
// stop_not_obeyed() holds until it is seen. A drive that was told to enable counts as energised until a heartbeat that
// is younger than the stop shows otherwise.
//
// What the drive says of errors is kept by the drive until Clear_Errors, which only reset_fault() sends.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/odrive/fault_code.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/odrive/setup_status.hpp"

namespace breakaway::odrive {

struct NodeSettings {
  std::uint8_t node_id = 1;
  bool polled = false;
  float velocity_limit_turns_s = 0, current_limit_A = 0;
  hal::Duration period{}, heartbeat_period{}, heartbeat_timeout{};
};

class DriveNode {
 public:
  // Requests are repeated after so long.
  static constexpr hal::Duration retell_time = std::chrono::milliseconds{20};
  static constexpr hal::Duration poll_time = std::chrono::milliseconds{10};
  static constexpr hal::Duration version_time = std::chrono::milliseconds{100};
  // A drive that says for longer that it starts has an error that a reset must clear.
  static constexpr hal::Duration start_time = std::chrono::seconds{3};
  // A drive that shows no position for longer may have booted anew meanwhile, however rare its heartbeats are.
  static constexpr hal::Duration boot_time = std::chrono::milliseconds{250};
  // A drive that was told so often to enable, and says why it does not, is not told again.
  static constexpr unsigned enable_attempts = 3;
  // How long the reason of a disarming that the heartbeat does not tell is asked for.
  static constexpr int explaining_periods = 5;

  explicit DriveNode(const NodeSettings& settings) noexcept : settings_{settings} {}

  // Takes a frame of this node.
  void on_frame(const hal::ReceivedFrame& received) noexcept;
  // An estimate came.
  void on_estimate(hal::Time time) noexcept { estimate_time_ = position_time_ = time; }
  // The drive reports a torque, or the lack of it.
  void on_torque(bool gives, hal::Time time) noexcept {
    gives_torque_ = gives;
    torque_time_ = time;
  }
  void update(hal::Time now) noexcept;
  // Returns true and fills `frame` when one is to be sent, at most one a call.
  bool next_frame(hal::CanFrame& frame, hal::Time now) noexcept;

  void request_enable() noexcept {
    if (phase_ != Phase::ready || has_force() || code() != 0 || wished_) return;
    wished_ = true;
    attempts_ = 0;
    told_ = explaining_ = 0;
    told_at_.reset();
  }
  void request_stop() noexcept {
    if (wished_) told_at_.reset();  // at once
    wished_ = running_ = false;
  }
  void reset_fault() noexcept { reset_asked_ = true; }
  // Somebody said where the axis stands: from now on a reboot is one that loses it, be the drive set up or not.
  void note_reference() noexcept { known_ = true; }
  // Something is wrong that the drive does not know of.
  void fail(OwnFault fault) noexcept;

  // It is there: its set-up goes on, or it gives torque.
  bool heard() const noexcept { return phase_ != Phase::waiting || has_force(); }
  // It obeys commands, for all that is known: one that shows a start may be in the middle of a run.
  bool hears() const noexcept { return heard() || starting_; }
  bool ready() const noexcept { return phase_ == Phase::ready; }
  bool refused() const noexcept { return phase_ == Phase::refused; }
  bool wished() const noexcept { return wished_; }
  // The drive is energised, and here it is wished.
  bool follows() const noexcept { return wished_ && running_; }
  bool has_force() const noexcept { return has_force_ || (unsure_ && !wished_); }
  bool stop_not_obeyed() const noexcept { return forced_; }
  bool heartbeat_lost() const noexcept { return lost_; }
  AxisState axis_state() const noexcept { return state_; }
  std::uint32_t errors() const noexcept { return errors_; }
  SetupStatus status() const noexcept;
  // What the drive is in fault for; 0: nothing.
  std::uint16_t code() const noexcept {
    return own_fault_ != OwnFault::none ? static_cast<std::uint16_t>(own_fault_)
           : kept_ != 0                 ? kept_
                                        : error_code(errors_);
  }
  // The first code that appeared since the last call; 0: none.
  std::uint16_t take_new_code() noexcept { return std::exchange(new_code_, std::uint16_t{0}); }
  // It may have booted anew since the last call.
  bool take_reboot() noexcept { return std::exchange(rebooted_, false); }

 private:
  enum class Phase : std::uint8_t { waiting, asking, telling, listening, ready, refused };

  void on_heartbeat(const Heartbeat& heartbeat, hal::Time time) noexcept;
  void on_version(Version version) noexcept;
  void on_errors(Errors errors) noexcept;
  void stop_for(std::uint16_t code) noexcept;
  void watch_silence(hal::Time now) noexcept;
  void watch_stop(hal::Time now) noexcept;
  void watch_wish() noexcept;
  void begin_reset() noexcept;
  void restart() noexcept;
  hal::Duration boots_within() const noexcept;
  hal::Duration obeys_within() const noexcept;
  hal::Duration enable_interval() const noexcept;
  bool next_stop_frame(hal::CanFrame& frame, hal::Time now) noexcept;
  bool next_setup_frame(hal::CanFrame& frame, hal::Time now) noexcept;
  bool next_enable_frame(hal::CanFrame& frame, hal::Time now) noexcept;
  bool next_question(hal::CanFrame& frame, hal::Time now) noexcept;

  NodeSettings settings_;
  Phase phase_ = Phase::waiting;
  AxisState state_ = AxisState::undefined;
  std::uint32_t errors_ = 0;
  std::uint8_t result_ = 0;
  OwnFault own_fault_ = OwnFault::none;
  std::uint16_t kept_ = 0;  // why it was not enabled, or left that state; until a reset
  std::uint16_t new_code_ = 0;
  std::optional<hal::Time> heartbeat_time_, torque_time_;
  std::optional<hal::Time> estimate_time_, position_time_;  // of this set-up, and of any
  std::optional<hal::Time> told_at_, idle_told_at_, asked_at_, version_asked_at_;
  std::optional<hal::Time> unwished_since_, initializing_since_;
  unsigned attempts_ = 0;
  int told_ = 0;        // messages of the set-up, and of an attempt to enable
  int explaining_ = 0;  // periods that are left for it
  bool wished_ = false;
  bool running_ = false;    // was seen in closed loop control since it was wished
  bool has_force_ = false;  // as it was seen last
  bool unsure_ = false;     // it was told to enable, and nothing has shown since what it made of it
  bool gives_torque_ = false;
  bool forced_ = false;
  bool estop_next_ = false;
  bool lost_ = false;
  bool rebooted_ = false;
  bool known_ = false;  // since its last boot-up it was ready, or was told where it stands
  bool starting_ = false;
  bool reset_asked_ = false, clear_wanted_ = false;
};

}  // namespace breakaway::odrive
