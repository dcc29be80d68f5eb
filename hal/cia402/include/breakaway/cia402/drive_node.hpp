// DriveNode: the CANopen side of one drive, from power-up to cyclic operation and back.
//
//   waiting -> configuring -> starting -> verifying_mode -> ready -> forcing_stop -> held
//                   |                          |
//                   +--------> refused <-------+
//
// It waits for the node to show up in Pre-operational, and makes it do so if it must: a silent node is told to reset
// its communication, one that runs already is taken back, and both are switched off by SDO meanwhile, in case that
// somebody left them with force. Then it sets the node up by SDO beside the cyclic traffic (setup_plan.hpp), starts it,
// and asks until 6061h shows cyclic synchronous torque. Until PDOs pass it looks at the statusword by SDO and hands out
// what it saw; a node that is seen with force is looked at until it has none. From then on it watches heartbeat, NMT
// state and emergencies. A node that reboots, in whatever phase, is set up anew; so is one that lost an object of its
// set-up, which rebooted unheard. One that leaves NMT operational by itself and did not is started again; one that
// stops answering is waited for, and told to say its boot-up. A node that cannot be used is refused until it reboots or
// is set up anew, and status() says why. One that does not obey a stop is forced to it (forced_stop.hpp), from whatever
// phase, and then held in Pre-operational, where no PDO reaches it, until it is set up anew: whoever else led it would
// lead it again.
//
//   once a period: give every received frame to on_frame(), call update(now), send what next_frame() hands out.
//
// It owns no port, holds no pointers, never blocks or allocates, and is for one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/heartbeat.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/object_address.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/cia402/drive_config.hpp"
#include "breakaway/cia402/forced_stop.hpp"
#include "breakaway/cia402/objects.hpp"
#include "breakaway/cia402/position_factor.hpp"
#include "breakaway/cia402/setup_plan.hpp"
#include "breakaway/cia402/setup_status.hpp"
#include "breakaway/cia402/torque_scale.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

enum class SetupPhase : std::uint8_t {
  waiting,         // until the node shows up in Pre-operational
  configuring,     // until the transfers of the set-up plan are done
  starting,        // until the node says that it is NMT operational
  verifying_mode,  // until 6061h shows cyclic synchronous torque, or the mode that was selected
  ready,           // until the node reboots or leaves NMT operational, or is forced to a stop
  forcing_stop,    // until the node is seen without force
  held,            // in Pre-operational, until it is set up anew
  refused,         // until the node reboots or is set up anew; status() says why
};

// The drive's own figures, as it told them.
struct DriveRating {
  std::uint32_t rated_current_mA = 0;  // 0: not told
  std::uint32_t rated_torque_mNm = 0;
  std::uint16_t max_torque_per_mille = 1000;  // of the rated torque; a drive without 6072h is not driven beyond it
  // 6072h as it was found after the last boot-up, before it was lowered to the axis' limit; 0: the drive has none.
  std::uint16_t found_max_torque_per_mille = 0;
};

class DriveNode {
 public:
  // A node that is silent is told to reset its communication, and given so long to boot before it is told again, then
  // twice as long each time, up to the longest.
  static constexpr hal::Duration boot_time = std::chrono::seconds{2};
  static constexpr hal::Duration longest_boot_time = std::chrono::seconds{8};
  // One that was forced to a stop answers so many looks without force and torque before it counts as quiet: whoever
  // else leads it may go on. Until then a stop that is forced again goes on with the means that the last one ended
  // with.
  static constexpr unsigned quiet_looks = 5;
  // A transfer is tried so often, each time with more patience (patience.hpp), before the node counts as gone. A node
  // that needed it is given it from then on.
  static constexpr unsigned sdo_attempts = 3;
  // A refusal that may pass, such as by a drive that still starts, is asked again at this interval, so often in a
  // set-up.
  static constexpr hal::Duration refusal_pause = std::chrono::milliseconds{100};
  static constexpr unsigned most_refusals = ForcedStop::refusal_time / refusal_pause;
  // 6061h is asked for at this interval, and 6060h written again at the longer one, until the time is over. Drives were
  // seen to take seconds.
  static constexpr hal::Duration poll_time = std::chrono::milliseconds{20};
  static constexpr hal::Duration mode_request_time = std::chrono::milliseconds{500};
  static constexpr hal::Duration mode_timeout = std::chrono::seconds{10};

  // A node with what check() does not accept is refused for good and sends nothing.
  template <class Scalar>
  DriveNode(const DriveConfig<Scalar>& drive, const hal::NetworkConfig& network, Scalar max_force_N) noexcept
      : heartbeat_timeout_{drive.heartbeat_timeout},
        rated_torque_mNm_{drive.rated_torque_mNm},
        force_per_torque_N_per_Nm_{static_cast<float>(drive.force_per_torque_N_per_Nm)},
        max_force_N_{static_cast<float>(max_force_N)},
        node_id_{drive.node_id},
        torque_base_{drive.torque_base},
        user_position_unit_{drive.user_position_unit},
        homes_{drive.homing.home == Home::by_drive},
        sdo_timeout_{drive.sdo_timeout},
        patience_{drive.sdo_timeout},
        config_valid_{internal::check_node(drive, network) == DriveConfigError::none},
        plan_{drive, network},
        sdo_{drive.node_id, drive.sdo_timeout},
        heartbeat_{drive.node_id, drive.heartbeat_timeout},
        emcy_{drive.node_id} {
    if (!config_valid_) refuse(SetupStatus::config_invalid);
  }

  // Takes any frame that the bus brought; those of other nodes are passed over.
  // `information`: the codes of EMCY messages that are no errors, DriveConfig::emcy_information.
  void on_frame(const hal::ReceivedFrame& received, const canopen::EmcyCodes& information) noexcept;
  // Moves on by one period, after the frames.
  void update(hal::Time now) noexcept;
  // Returns true and fills `frame` when an NMT command or an SDO frame is to be sent, which must then be sent: at most
  // one a call. The master's heartbeat is not among them, because it is one for all its drives.
  bool next_frame(hal::CanFrame& frame, hal::Time now) noexcept;
  // The node was told to stop and is still energised: it is told by ever stronger means.
  void force_stop(hal::Time now) noexcept;
  // The newest PDO shows a state without force and no torque: where PDOs pass, that proves a forced stop, too.
  void on_quiet_pdo(hal::Time now) noexcept;
  // The node is waited for and set up as if it were new.
  void set_up_anew(hal::Time now) noexcept;
  // Has the drive take another mode, which it then shows when the node is ready again. Cyclic synchronous torque is
  // that of every set-up. Only a node that is ready does.
  void select_mode(Mode mode, hal::Time now) noexcept;
  // What its set-up takes beside what another's does, because it is slow to answer.
  hal::Duration extra_time() const noexcept {
    return is_slow_ ? static_cast<int>(plan_.steps().size()) * patience_ : hal::Duration::zero();
  }
  // Has 603Fh read, once the node is ready.
  void request_error_code() noexcept { error_code_wanted_ = true; }
  void forget_errors() noexcept;
  // A node that is waited for is lost no longer: it is expected, and heard again or not.
  void forget_heartbeat_loss() noexcept {
    if (phase_ == SetupPhase::waiting) heartbeat_.stop();
  }

  SetupPhase phase() const noexcept { return phase_; }
  bool ready() const noexcept { return phase_ == SetupPhase::ready; }
  // The drive is ready and shows this mode, or is asked for it.
  bool in_mode(Mode mode) const noexcept { return mode_ == mode && (ready() || phase_ == SetupPhase::verifying_mode); }
  bool forcing_stop() const noexcept { return phase_ == SetupPhase::forcing_stop; }
  // It did not obey a stop, and waits to be set up anew.
  bool held() const noexcept { return phase_ == SetupPhase::held; }
  // It was forced to a stop, and is not quiet yet.
  bool quietens() const noexcept { return looks_wanted_ > 0 && (held() || phase_ == SetupPhase::refused); }
  // The node is NMT operational with our mapping: PDOs pass.
  bool operational() const noexcept {
    return phase_ == SetupPhase::verifying_mode || ready() ||
           (forcing_stop() && forced_while_operational_ && forced_stop_.means() == ForcedStop::Means::controlword);
  }
  // It was operational, and said that it no longer is or that it booted, which may be wrong, or is still to be told.
  bool restarts() const noexcept {
    if (phase_ == SetupPhase::waiting) return leaves_;
    return restarts_ && (phase_ == SetupPhase::starting || phase_ == SetupPhase::configuring);
  }
  // Returns the statusword that was read by SDO since the last call, if one was.
  std::optional<std::uint16_t> take_statusword() noexcept { return std::exchange(statusword_, std::nullopt); }

  SetupStatus status() const noexcept { return status_; }
  // The object at which the set-up stands, was not answered, or was refused; index 0 when none is concerned.
  canopen::ObjectAddress setup_object() const noexcept { return setup_object_; }
  // Why the drive aborted, when status() is object_refused; SdoAbort::none otherwise.
  canopen::SdoAbort setup_abort_code() const noexcept {
    return status_ == SetupStatus::object_refused ? abort_code_ : canopen::SdoAbort::none;
  }

  const DriveRating& rating() const noexcept { return rating_; }
  // 603Fh as it was last read; 0 when it was not.
  std::uint16_t error_code() const noexcept { return error_code_; }
  std::optional<canopen::NmtState> nmt_state() const noexcept { return heartbeat_.state(); }
  bool heartbeat_lost() const noexcept { return heartbeat_.lost(); }
  // It was told to produce heartbeats by a set-up that is not over.
  bool heartbeat_lost_in_setup() const noexcept {
    const bool in_setup =
        phase_ == SetupPhase::configuring || phase_ == SetupPhase::starting || phase_ == SetupPhase::verifying_mode;
    return in_setup && heartbeat_.lost();
  }
  const canopen::EmcyConsumer& emcy() const noexcept { return emcy_; }
  std::uint16_t take_emergency() noexcept { return emcy_.take_error(); }
  // Counts the boot-ups since the node was first heard: each takes its set-up and its reference.
  std::uint32_t reboots() const noexcept { return reboots_; }

 private:
  void wait_for_node(hal::Time now) noexcept;
  void tell_while_waiting(canopen::NmtCommand command, hal::Time now) noexcept;
  void switch_off() noexcept;
  void ask_again(hal::Time now) noexcept;
  void on_boot() noexcept;
  void on_boot_up(hal::Time now) noexcept;
  void begin_configuration(hal::Time now) noexcept;
  void configure(hal::Time now) noexcept;
  SetupStep current_step() const noexcept;
  static bool clears_mapping(const SetupStep& step) noexcept;
  void start_transfer(const SetupStep& step) noexcept;
  void on_step_done(const SetupStep& step, bool answered, hal::Time now) noexcept;
  bool on_recalled(bool as_it_was, hal::Time now) noexcept;
  bool holds(const SetupStep& step) const noexcept;
  bool shows_value_of(const SetupStep& step) const noexcept;
  bool is_needless(const SetupStep& step) const noexcept;
  void be_patient() noexcept;
  void on_step_failed(canopen::SdoResult result, hal::Time now) noexcept;
  void on_value_read(std::uint16_t index) noexcept;
  void judge_position_factor() noexcept;
  void on_rated_torque(std::uint32_t rated_torque_mNm) noexcept;
  std::uint16_t torque_limit_per_mille(std::uint16_t most) const noexcept;
  bool torque_base_is_as_designed() const noexcept;
  void begin_start(hal::Time now) noexcept;
  bool stopped_operating(hal::Time now) noexcept;
  void start_node(hal::Time now) noexcept;
  bool is_looking(hal::Time now) noexcept;
  void look(std::uint16_t index) noexcept;
  void on_look(canopen::SdoResult result, hal::Time now) noexcept;
  void end_look(canopen::SdoResult result, bool quiet) noexcept;
  void look_now_and_then(hal::Time now) noexcept;
  void hold(hal::Time now) noexcept;
  void enter_held(hal::Time now) noexcept;
  // What answered slowly once may do so again.
  hal::Duration usual_patience() const noexcept { return is_slow_ ? patience_ : sdo_timeout_; }
  void verify_mode(hal::Time now) noexcept;
  void on_mode_transfer(canopen::SdoResult result, hal::Time now) noexcept;
  void watch(hal::Time now) noexcept;
  void update_forced_stop(hal::Time now) noexcept;
  void end_forced_stop(hal::Time now) noexcept;
  void enter(SetupPhase phase, hal::Time now) noexcept;
  void drop_transfer() noexcept;
  void refuse(SetupStatus status) noexcept;

  hal::Duration heartbeat_timeout_;
  std::uint32_t rated_torque_mNm_;
  float force_per_torque_N_per_Nm_;
  float max_force_N_;
  std::uint8_t node_id_;
  TorqueBase torque_base_;
  bool user_position_unit_;
  bool homes_;
  hal::Duration sdo_timeout_, patience_;  // patience_: for an answer of the set-up
  bool config_valid_;
  SetupPlan plan_;
  canopen::SdoClient sdo_;
  canopen::HeartbeatConsumer heartbeat_;
  canopen::EmcyConsumer emcy_;
  ForcedStop forced_stop_;

  std::optional<hal::Time> since_;         // when the phase was entered
  std::optional<hal::Time> last_command_;  // when NMT was last told something in this phase
  std::optional<hal::Time> last_poll_;
  hal::Time last_mode_request_{};
  std::size_t step_ = 0;
  std::uint16_t fixed_mapping_ = 0;  // 1600h or 1A00h, whichever the drive refused to clear last; 0: neither
  unsigned attempts_ = 0;
  unsigned looks_wanted_ = 0;            // until it is quiet
  hal::Duration look_patience_{};        // for a statusword beside the plan
  hal::Duration boot_time_ = boot_time;  // that a silent node is given
  unsigned refusals_ = 0;                // that may pass, in this set-up
  hal::Time pause_end_{};                // after such a refusal
  std::uint32_t reboots_ = 0;
  DriveRating rating_;
  PositionFactor position_factor_;
  std::uint8_t position_ends_ = 0;  // which ends of 607Bh were read
  canopen::ObjectAddress setup_object_{};
  canopen::SdoAbort abort_code_ = canopen::SdoAbort::none;  // at the refusal
  std::optional<canopen::NmtCommand> nmt_command_;
  std::optional<std::uint16_t> statusword_;
  std::uint16_t error_code_ = 0;
  SetupPhase phase_ = SetupPhase::waiting;
  SetupStatus status_ = SetupStatus::in_progress;
  Mode mode_ = Mode::cyclic_torque;  // that 6061h must show
  bool mode_write_ = false;          // the running transfer is a renewed request of the mode
  bool reset_told_ = false;          // the last command in `waiting`
  bool answers_ = false;             // by SDO, after that command
  bool is_slow_ = false;             // it answered with more patience than it has at first
  bool transfer_running_ = false;
  bool looks_at_torque_ = false;            // in the running look
  bool leaves_ = false;                     // in `waiting`: it was operational, and was not told yet
  bool restarts_ = false;                   // in `configuring` and `starting`: it was operational
  bool recalls_ = false;                    // it has of its set-up what a boot would take
  bool quiet_state_ = false;                // by the look at its statusword
  bool write_taken_ = false;                // the last one of the plan
  bool forced_while_operational_ = false;   // the forced stop began while PDOs passed
  std::optional<SetupStatus> refused_for_;  // by a drive that was refused before it was forced to stop
  bool error_code_wanted_ = false;
  bool known_ = false;  // its set-up was begun at least once
};

}  // namespace breakaway::cia402
