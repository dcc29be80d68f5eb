// StateMachine: the master's side of the CiA 402 states. It reads statuswords and walks the drive by controlwords to
// where it is wished to be.
//
// A wish to enable holds until the drive leaves Operation enabled on its own (by a fault, a quick stop or a silent drop
// to a lower state) or reboots: the drive must not be energised again without a new request_enable().
#pragma once

#include <cstdint>
#include <optional>

#include "breakaway/cia402/state.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

class StateMachine {
 public:
  // Each level of the fault reset bit is shown for so long: some drives miss changes less than 1 ms apart, and a
  // controlword acts only at the SYNC after the one that it was sent for. And in so many controlwords: one may be lost.
  static constexpr hal::Duration reset_level_time = std::chrono::milliseconds{3};
  static constexpr std::uint8_t reset_level_updates = 3;
  // A drive that stays in Quick stop active (options 5..8 of 605Ah) is switched off after this.
  static constexpr hal::Duration quick_stop_time = std::chrono::seconds{1};

  // A drive in Fault ignores a request to enable: its fault is reset first. A drive that is not ignores a reset.
  void request_enable() noexcept;
  void request_stop() noexcept { enable_ = false; }
  void reset_fault() noexcept;
  // The drive lost power or configuration, so nothing is known of it and nothing is wished any more.
  void restart() noexcept { *this = {}; }

  void on_statusword(std::uint16_t statusword) noexcept;
  // Decides on the next controlword, once a period.
  void update(hal::Time now) noexcept;

  std::uint16_t controlword() const noexcept { return controlword_; }
  // Holds nothing before the first statusword that the profile defines.
  std::optional<State> state() const noexcept { return state_; }
  bool enable_wished() const noexcept { return enable_; }
  // Returns true when the drive says that it is without force.
  bool without_force() const noexcept { return state_ && is_without_force(*state_); }
  // Returns true while the drive is to follow its target torque.
  bool follows() const noexcept { return enable_ && state_ == State::operation_enabled; }

 private:
  enum class Reset : std::uint8_t { none, low, high };

  std::uint16_t next_controlword(hal::Time now) noexcept;
  std::uint16_t reset_controlword(hal::Time now) noexcept;

  std::optional<State> state_;
  bool enable_ = false;
  std::uint16_t controlword_ = control::disable_voltage;
  Reset reset_ = Reset::none;
  std::uint8_t reset_updates_{};  // that showed the level, up to the least
  std::optional<hal::Time> reset_since_;
  std::optional<hal::Time> quick_stop_since_;
};

}  // namespace breakaway::cia402
