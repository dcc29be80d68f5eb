// DriveEmulator: a CiA 402 servo drive as a CANopen node in simulated time, with a motor and an encoder on a mechanism.
//
// The server side of the protocols is written from the standards and shares only constants with the project's client,
// so that a mistake in one is not mirrored by the other. Time enters by the calls below only and must never decrease.
//
// A SYNC has this done, in this order: the mechanism moves to the time of the SYNC; encoder and torque are sampled; the
// command that a synchronous RPDO brought since the SYNC before takes effect; synchronous TPDOs are filled and sent. A
// drive that leaves NMT Operational removes its torque and goes to Switch on disabled.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <random>

#include "breakaway/canopen/nmt.hpp"
#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/drive_emulator/emergency.hpp"
#include "breakaway/drive_emulator/emulated_drive.hpp"
#include "breakaway/drive_emulator/mechanism.hpp"
#include "breakaway/drive_emulator/object_dictionary.hpp"
#include "breakaway/drive_emulator/pdo.hpp"
#include "breakaway/drive_emulator/power_drive.hpp"
#include "breakaway/drive_emulator/sdo_server.hpp"
#include "breakaway/drive_emulator/timers.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::drive_emulator {

class DriveEmulator final : public EmulatedDrive {
 public:
  static constexpr std::size_t pdo_count = 4;  // in each direction
  // Called with each frame that the drive puts into its transmit queue, and when. It must not call the drive.
  using Send = std::function<void(const hal::CanFrame&, hal::Time)>;

  // The drive is powered off at first. `mechanism` must outlive it. Throws InputError (see validate()).
  DriveEmulator(const EmulatorConfig& config, Mechanism& mechanism, Send send);
  DriveEmulator(const DriveEmulator&) = delete;
  DriveEmulator& operator=(const DriveEmulator&) = delete;

  // The boot-up message follows after boot_duration.
  void power_on(hal::Time time) override;
  void power_off(hal::Time time) override;
  void on_frame(const hal::CanFrame& frame, hal::Time time) override;
  void advance_to(hal::Time time) override;
  std::optional<hal::Time> next_event() const override;
  void advance_mechanism_to(hal::Time time) override;

  // Has the drive fault. 603Fh and the EMCY show the code; the cause is momentary, so that a fault reset succeeds.
  void trip_fault(std::uint16_t code, hal::Time time);
  // Unplugs the bus. The drive itself runs on.
  void set_silent(bool silent) { silent_ = silent; }
  void suppress_heartbeat(bool suppressed) { heartbeat_suppressed_ = suppressed; }

  // Safe torque off is Switch on disabled, a missing supply of the power stage Ready to switch on or Switched on: the
  // drive does not go beyond, and falls back to it, unannounced. Nothing: whatever it was is over.
  void inhibit_beyond(std::optional<cia402::State> highest, hal::Time time);
  // The most that the motor can do from here on, > 0: a supply that has dropped, or a hot motor.
  void limit_peak_force(double peak_force_N, hal::Time time);
  // SDO answers take so long from here on, >= 0.
  void delay_sdo_responses(hal::Duration delay) { sdo_response_delay_ = delay; }

  // These tell what is true, whatever the bus says.
  cia402::State state() const { return drive_.state(); }
  // boot_up: the drive is off or boots.
  canopen::NmtState nmt_state() const { return nmt_; }
  const ObjectDictionary& objects() const { return dictionary_; }
  const model::AppliedForce& force() const override { return drive_.motor().segment(); }
  double largest_force_N(hal::Time end) const override;
  // The listener is called with each new force segment; the one before ends where it starts.
  void on_force_segment(std::function<void(const model::AppliedForce&)> listener) {
    drive_.on_force_segment(std::move(listener));
  }

 private:
  enum Timer : std::size_t {
    boot,
    heartbeat_due,
    master_heartbeat,
    sync_alarm,
    sdo_timeout,
    information,
    rpdo_deadline,                           // the first of pdo_count timers
    tpdo_event = rpdo_deadline + pdo_count,  // likewise
    timer_count = tpdo_event + pdo_count,
  };
  struct TpdoState {
    unsigned syncs = 0;  // since the last transmission
    bool event = false;  // type 0: something changed, and the next SYNC is to tell it
    std::optional<hal::Time> sent;
  };

  void finish_boot();
  void on_written(Address address);
  void on_time(std::size_t timer);
  void dispatch(const hal::CanFrame& frame);
  void settle();
  void schedule_information();
  void flush();

  void on_nmt(const hal::CanFrame& frame);
  void enter(canopen::NmtState state);
  void reset(canopen::NmtCommand command);
  void on_sdo(const hal::CanFrame& frame);
  std::optional<std::uint16_t> master_heartbeat_id() const;
  void on_master_heartbeat();
  void lose_master();

  void on_sync(const hal::CanFrame& frame);
  void restart_sync_alarm();
  void on_rpdo(std::size_t number, const hal::CanFrame& frame);
  bool inside_sync_window() const;
  void send_synchronous_tpdos();
  void note_event(std::uint16_t index);
  void schedule_event(std::size_t number);
  void transmit(std::size_t number);

  void post(const hal::CanFrame& frame, hal::Duration delay = {});
  void post_heartbeat(canopen::NmtState state);
  void restart_heartbeat();
  hal::Duration tpdo_delay();
  bool operational() const { return nmt_ == canopen::NmtState::operational; }
  std::int64_t get(std::uint16_t index, std::uint8_t sub = 0) const { return dictionary_.get({index, sub}); }

  const EmulatorConfig config_;
  Send send_;
  ObjectDictionary dictionary_;
  EmergencyProducer emergency_;
  SdoServer sdo_;
  PowerDrive drive_;
  std::deque<Pdo> rpdos_;  // a deque, because a PDO cannot be moved
  std::deque<Pdo> tpdos_;
  Timers<timer_count> timers_;
  std::multimap<hal::Time, hal::CanFrame> outgoing_;
  std::mt19937_64 random_;

  hal::Time now_{};
  hal::Duration sdo_response_delay_;
  hal::Time sdo_ready_{};
  bool powered_ = false;
  bool silent_ = false;
  bool heartbeat_suppressed_ = false;
  canopen::NmtState nmt_ = canopen::NmtState::boot_up;
  std::optional<hal::Time> last_sync_;
  std::int64_t last_mode_display_ = 0;
  std::array<std::optional<hal::CanFrame>, pdo_count> latched_{};  // synchronous RPDOs that wait for their SYNC
  std::array<TpdoState, pdo_count> tpdo_states_{};
};

}  // namespace breakaway::drive_emulator
