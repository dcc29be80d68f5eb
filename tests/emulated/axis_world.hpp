// The world of a controller on CAN, in steps of a period: the drive emulator with the axis behind it, and another node
// that sends the controller on its tour of targets twice. The same code on the host and on a second processor.
//
// Frames of one period count as sent at its beginning, whenever in the period they came, and so what the world does
// depends on what the controller says only.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "axis_scene.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/sil/braked_slide.hpp"
#include "node_config.hpp"
#include "tour.hpp"

namespace breakaway::emulated {

// A frame as the bus carried it, as it lies in files.
struct LoggedFrame {
  std::uint32_t period;
  std::uint16_t id;
  std::uint8_t size;
  std::uint8_t from_controller;
  std::array<std::uint8_t, 8> data;
  friend bool operator==(const LoggedFrame&, const LoggedFrame&) = default;
};
static_assert(sizeof(LoggedFrame) == 16);

class AxisWorld {
 public:
  using Send = std::function<void(const hal::CanFrame&)>;

  // send: puts a frame on the bus; must not call back. periods: that will be logged.
  AxisWorld(std::uint32_t periods, Send send)
      : send_{std::move(send)},
        mechanism_{resting_axis()},
        drive_{drive_config(), mechanism_, [this](const hal::CanFrame& frame, hal::Time) { transmit(frame); }} {
    frames_.reserve(std::size_t{4} * periods + 1000);
    positions_m_.reserve(periods);
    drive_.power_on(hal::Time{});
  }
  AxisWorld(const AxisWorld&) = delete;
  AxisWorld& operator=(const AxisWorld&) = delete;

  // A frame of the controller, in the present period.
  void take(const hal::CanFrame& frame) {
    log(frame, true);
    drive_.on_frame(frame, now());
  }

  // To the beginning of the next period. The brake opens with the first period that finds the drive enabled.
  void pass_period() {
    ++periods_;
    while (const auto next = drive_.next_event()) {
      if (*next > now()) break;
      drive_.advance_to(*next);
    }
    drive_.advance_to(now());
    drive_.advance_mechanism_to(now());
    positions_m_.push_back(mechanism_.position_m());
    if (!mechanism_.released() && drive_.state() == cia402::State::operation_enabled)
      mechanism_.release(hal::seconds(now()));
    command();
  }

  std::uint32_t periods() const { return periods_; }
  double error_m() const { return mechanism_.position_m() - target_counts_ * drive_config().encoder_resolution_m; }
  bool resting() const { return mechanism_.slide().sticking(); }
  const std::vector<LoggedFrame>& frames() const { return frames_; }
  // At the end of every period.
  const std::vector<double>& positions_m() const { return positions_m_; }

 private:
  static constexpr std::uint32_t first_command = 10;  // period
  static constexpr double lap_s = bench::tour_s + 0.6;
  hal::Time now() const { return hal::Time{flashed::node.loop.period * static_cast<std::int64_t>(periods_)}; }

  void command() {
    if (periods_ < first_command) return;
    if (mechanism_.released()) tour_time_s_ += hal::seconds(flashed::node.loop.period);
    const double in_lap_s = tour_time_s_ < lap_s ? tour_time_s_ : tour_time_s_ - lap_s;
    const std::int32_t target = bench::target_counts(in_lap_s, drive_config().encoder_resolution_m);
    if (std::exchange(commanded_, true) && target == target_counts_) return;
    target_counts_ = target;
    transmit(
        firmware::encode_command({.axis = 0, .enable = true, .target_counts = target}, flashed::node.loop.node_id));
  }
  void transmit(const hal::CanFrame& frame) {
    log(frame, false);
    send_(frame);
  }
  void log(const hal::CanFrame& frame, bool from_controller) {
    LoggedFrame entry{periods_, frame.id, frame.size, static_cast<std::uint8_t>(from_controller), {}};
    std::copy_n(frame.data.begin(), frame.size, entry.data.begin());
    frames_.push_back(entry);
  }

  Send send_;
  sil::BrakedSlide mechanism_;
  std::vector<LoggedFrame> frames_;
  std::vector<double> positions_m_;
  drive_emulator::DriveEmulator drive_;
  double tour_time_s_ = 0;
  std::int32_t target_counts_ = 0;
  std::uint32_t periods_ = 0;
  bool commanded_ = false;
};

}  // namespace breakaway::emulated
