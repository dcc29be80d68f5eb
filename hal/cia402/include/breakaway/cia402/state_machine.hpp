// Walks a drive through the CiA 402 states by controlwords: the master's side of the state machine.
//
// A wish to enable holds until the drive leaves Operation enabled on its own (fault, quick stop by itself, silent drop
// to a lower state) or reboots: the drive must not be energised again without a new request_enable.
#pragma once

#include <cstdint>
#include <optional>

#include "breakaway/cia402/state.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

class StateMachine {
 public:
  // How long each level of the fault reset bit is shown: some drives miss changes less than 1 ms apart, and a
  // controlword acts only at the SYNC after the one that it was sent for.
  static constexpr hal::Duration reset_level_time = std::chrono::milliseconds{3};
  // A drive that stays in Quick stop active (options 5..8 of 605Ah) is switched off after this.
  static constexpr hal::Duration quick_stop_time = std::chrono::seconds{1};

  // enable: ignored while the drive is in Fault; reset it first. reset_fault: ignored unless in Fault.
  void request_enable() noexcept;
  void request_stop() noexcept { enable_ = false; }
  void reset_fault() noexcept;
  // The drive lost power or configuration: nothing is known and nothing is wished.
  void restart() noexcept { *this = {}; }

  void on_statusword(std::uint16_t statusword) noexcept;
  // Once a period: decides on the next controlword.
  void update(hal::Time now) noexcept;

  std::uint16_t controlword() const noexcept { return controlword_; }
  std::optional<State> state() const noexcept { return state_; }  // nothing before the first defined statusword
  bool enable_wished() const noexcept { return enable_; }
  // The drive is to follow its target torque.
  bool follows() const noexcept { return enable_ && state_ == State::operation_enabled; }

 private:
  enum class Reset : std::uint8_t { none, low, high };

  std::uint16_t next_controlword(hal::Time now) noexcept;
  std::uint16_t reset_controlword(hal::Time now) noexcept;

  std::optional<State> state_;
  bool enable_ = false;
  std::uint16_t controlword_ = control::disable_voltage;
  Reset reset_ = Reset::none;
  std::optional<hal::Time> reset_since_;
  std::optional<hal::Time> quick_stop_since_;
};

}  // namespace breakaway::cia402
