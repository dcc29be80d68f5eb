// The world of a controller on CAN, in steps of a period: an emulated drive with its axis behind it for every axis of
// the node, another node that sends each on its tour of targets twice, the second one in the other direction, and a
// tool that looks into the node. The same code on the host and on a second processor.
//
// Frames of one period count as sent at its beginning, whenever in the period they came, and so what the world does
// depends on what the controller says only.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "flashed_node.hpp"
#include "tour.hpp"
#include "world_axes.hpp"

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

static_assert(flashed::node.count == world_axes.size());

// A tool that reads every entry of every axis of the node by SDO, over and over, one request a period. A request that
// the node did not answer in its period gives way to the next.
class Looker {
 public:
  hal::CanFrame next() {
    const auto axis = static_cast<std::uint8_t>(asked_ / std::size(requests) % world_axes.size());
    const Request& request = requests[asked_++ % std::size(requests)];
    return {.id = canopen::sdo_request_cob_id(flashed::node.loop.network.node_id),
            .size = 8,
            .data = {request.command, static_cast<std::uint8_t>(1 + axis), 0x21, request.subindex}};
  }

 private:
  struct Request {
    std::uint8_t command, subindex;
  };
  static constexpr std::uint8_t read = 0x40, segment = 0x60, next_segment = 0x70;
  // The names take a segment or two.
  static constexpr Request requests[] = {{read, 0x00}, {read, 0x01}, {segment, 0}, {read, 0x02},      {read, 0x03},
                                         {read, 0x04}, {read, 0x05}, {read, 0x06}, {read, 0x07},      {read, 0x08},
                                         {read, 0x09}, {read, 0x0A}, {segment, 0}, {next_segment, 0}, {read, 0x0B},
                                         {read, 0x0C}, {read, 0x0D}, {read, 0x0E}, {read, 0x0F},      {read, 0x10}};

  std::size_t asked_ = 0;
};

class NodeWorld {
 public:
  using Send = std::function<void(const hal::CanFrame&)>;

  // send: puts a frame on the bus; must not call back. periods: that will be logged.
  NodeWorld(std::uint32_t periods, Send send) : send_{std::move(send)} {
    frames_.reserve(std::size_t{9} * periods + 1000);
    positions_m_.reserve(world_axes.size() * periods);
    for (std::size_t i = 0; i < world_axes.size(); ++i) axes_.push_back(std::make_unique<Axis>(*this, i));
  }
  NodeWorld(const NodeWorld&) = delete;
  NodeWorld& operator=(const NodeWorld&) = delete;

  // A frame of the controller, in the present period.
  void take(const hal::CanFrame& frame) {
    log(frame, true);
    for (const auto& axis : axes_) axis->drive.on_frame(frame, now());
  }

  // To the beginning of the next period. The brakes open with the first period that finds every drive enabled.
  void pass_period() {
    ++periods_;
    bool enabled = true;
    for (const auto& axis : axes_) {
      axis->pass_period(now());
      positions_m_.push_back(axis->position_m());
      enabled = enabled && axis->drive.state() == cia402::State::operation_enabled;
    }
    if (enabled && !released_) release();
    command();
    transmit(looker_.next());
  }

  std::uint32_t periods() const { return periods_; }
  double error_m(std::size_t axis) const {
    return axes_[axis]->position_m() - axes_[axis]->target_counts * drive_config(axis).encoder_resolution_m;
  }
  bool resting(std::size_t axis) const { return axes_[axis]->mechanism.slide().sticking(); }
  // Every axis rests where it was sent last.
  bool settled() const {
    for (std::size_t i = 0; i < axes_.size(); ++i)
      if (!resting(i) || !(std::abs(error_m(i)) <= settle_tolerance_m)) return false;
    return true;
  }
  const std::vector<LoggedFrame>& frames() const { return frames_; }
  // At the end of every period, of one axis after the other.
  const std::vector<double>& positions_m() const { return positions_m_; }

 private:
  struct Axis {
    Axis(NodeWorld& world, std::size_t place)
        : mechanism{resting_axis(place), world_axes[place].mounting},
          drive{drive_config(place), mechanism,
                [&world](const hal::CanFrame& frame, hal::Time) { world.transmit(frame); }} {
      drive.power_on(hal::Time{});
    }
    void pass_period(hal::Time now) {
      while (const auto next = drive.next_event()) {
        if (*next > now) break;
        drive.advance_to(*next);
      }
      drive.advance_to(now);
      drive.advance_mechanism_to(now);
    }
    double position_m() const { return mechanism.slide().state().position_m; }

    sil::BrakedSlide mechanism;
    drive_emulator::DriveEmulator drive;
    std::int32_t target_counts = 0;
  };

  static constexpr std::uint32_t first_command = 10;      // period
  static constexpr std::uint32_t said_again_after = 100;  // periods; the controller waits for five times as long
  static constexpr double lap_s = bench::tour_s + 0.6;
  static constexpr const hal::NetworkConfig& network = flashed::node.loop.network;
  hal::Time now() const { return hal::Time{network.period * static_cast<std::int64_t>(periods_)}; }

  void release() {
    for (const auto& axis : axes_) axis->mechanism.release(hal::seconds(now()));
    released_ = true;
  }

  void command() {
    if (periods_ < first_command) return;
    if (released_) tour_time_s_ += hal::seconds(network.period);
    const double in_lap_s = tour_time_s_ < lap_s ? tour_time_s_ : tour_time_s_ - lap_s;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const std::int32_t counts = bench::target_counts(in_lap_s, drive_config(i).encoder_resolution_m);
      const std::int32_t target = i % 2 == 0 ? counts : -counts;
      // "Enable" is an edge, so that it is not said with the first command.
      const bool due = periods_ % said_again_after == i;
      if (commanded_ && target == axes_[i]->target_counts && !due) continue;
      axes_[i]->target_counts = target;
      transmit(firmware::encode_command(
          {.axis = static_cast<std::uint8_t>(i), .enable = commanded_, .target_counts = target}, network.node_id));
    }
    commanded_ = true;
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
  Looker looker_;
  std::vector<LoggedFrame> frames_;
  std::vector<double> positions_m_;
  std::vector<std::unique_ptr<Axis>> axes_;
  double tour_time_s_ = 0;
  std::uint32_t periods_ = 0;
  bool released_ = false;
  bool commanded_ = false;
};

}  // namespace breakaway::emulated
