// Homing: leads a drive through its own homing (CiA 402-2, homing mode), which gives an incremental encoder its zero.
//
//   selecting -> seeking -> stopping -> returning -> idle
//
// The drive is taken to the mode "homing", enabled and told to start; it moves by itself, by its method (6098h), and
// says when it has found its home, from where it counts (607Ch). Then it is stopped and taken back to cyclic
// synchronous torque. While it seeks, its force is bounded by its largest torque (6072h) only, and its position by
// nothing. An end without a home has failed, but for one that somebody asked for.
//
// Drive owns the means; this decides on the steps. It never blocks or allocates, and is for one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "breakaway/cia402/homing_config.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

class Homing {
 public:
  enum class Stage : std::uint8_t {
    idle,
    selecting,  // until the drive shows the mode "homing"
    seeking,    // until it has found its home, or fails
    stopping,   // until it is without force
    returning,  // until it shows cyclic synchronous torque again
  };

  // A drive may still show that it has found its home before, for so long after it was told to start.
  static constexpr hal::Duration start_time = std::chrono::milliseconds{50};

  explicit constexpr Homing(const HomingConfig& config) noexcept : config_{config} {}

  void begin() noexcept {
    stage_ = Stage::selecting;
    found_ = failed_ = false;
  }
  // The drive is no longer the one that was led: it rebooted, is forced to a stop, or lost its set-up. One that was
  // seeking has failed, or it would be energised anew, again and again, without a name.
  void lose() noexcept {
    const bool sought = stage_ == Stage::seeking;
    if (stage_ != Stage::idle) *this = Homing{config_};
    failed_ = failed_ || sought;
  }
  void forget_failure() noexcept { failed_ = false; }

  // The drive shows the mode "homing" and a state.
  void on_selected(hal::Time now) noexcept {
    stage_ = Stage::seeking;
    since_ = now;
    started_.reset();
  }
  // Once a period while it seeks. `follows`: it is in Operation enabled and wished to be there. Returns true when it is
  // to be stopped.
  bool seek(std::uint16_t statusword, bool wished, bool follows, hal::Time now) noexcept {
    if (follows && !started_) started_ = now;
    const bool answers = started_ && now - *started_ >= start_time;
    constexpr unsigned both = status_bit::homing_attained | status_bit::target_reached;
    const bool error = answers && (statusword & status_bit::homing_error) != 0;
    found_ = answers && follows && !error && (statusword & both) == both;
    failed_ = !found_ && (error || !wished || now - since_ > config_.timeout);
    if (found_ || failed_) stage_ = Stage::stopping;
    return found_ || failed_;
  }
  // Somebody asked for a stop.
  void stop() noexcept {
    if (stage_ == Stage::selecting || stage_ == Stage::seeking) stage_ = Stage::stopping;
  }
  // It is without force. Returns true when it counts from its home now.
  bool on_stopped() noexcept {
    stage_ = Stage::returning;
    return found_;
  }
  void on_returned() noexcept { stage_ = Stage::idle; }

  Stage stage() const noexcept { return stage_; }
  bool active() const noexcept { return stage_ != Stage::idle; }
  // The last one ended without a home, and nobody forgot it.
  bool failed() const noexcept { return failed_; }

 private:
  HomingConfig config_;
  Stage stage_ = Stage::idle;
  bool found_ = false, failed_ = false;
  hal::Time since_{};
  std::optional<hal::Time> started_;
};

}  // namespace breakaway::cia402
