// The node that is shipped, an emulated drive with its axis, a remote commander and another tool, on one virtual bus in
// virtual time; each can be made to fail.
#pragma once

#include <cmath>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <random>

#include "../realtime_guard.hpp"
#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/drive_emulator/drive_emulator.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/virtual_bus/virtual_bus.hpp"
#include "tampered_axis.hpp"
#include "tampered_port.hpp"

namespace breakaway::campaign {

using namespace std::chrono_literals;
using BusPort = virtual_bus::VirtualBus::Port;
using CampaignNode = firmware::FlashedNode<float, 1>;

// A drive on a port of the bus. What a mechanism refuses waits for advance_to(), because the bus lets no exception
// through.
class BusNode {
 public:
  BusNode(BusPort& port, const drive_emulator::EmulatorConfig& config, drive_emulator::Mechanism& mechanism)
      : drive{config, mechanism,
              [&port](const hal::CanFrame& frame, hal::Time at) { static_cast<void>(port.send(frame, at + 1s)); }} {
    port.set_listener(
        [](void* self, const hal::ReceivedFrame& received) noexcept { static_cast<BusNode*>(self)->receive(received); },
        this);
  }
  void advance_to(hal::Time now) {
    if (refusal_) std::rethrow_exception(refusal_);
    drive.advance_to(now);
  }
  drive_emulator::DriveEmulator drive;

 private:
  void receive(const hal::ReceivedFrame& received) noexcept {
    if (refusal_) return;
    try {
      drive.on_frame(received.frame, received.time);
    } catch (...) {
      refusal_ = std::current_exception();
    }
  }
  std::exception_ptr refusal_;
};

class FaultWorld {
 public:
  static constexpr hal::Duration period = 1ms;
  static constexpr double max_force_N = 50;  // the axis' limit; the drive could do twice that
  // Of the law 2 µm; half a count of the reading, and one of a reference.
  static constexpr double tolerance_m = 4e-6;
  static constexpr double lag_s = 1e-4;
  static constexpr std::uint8_t drive_id = 1;

  using Port = TamperedPort<BusPort>;
  using Node = firmware::ControlNode<Port, CampaignNode>;

  FaultWorld(const CampaignNode& node, double start_m, std::uint64_t seed)
      : flashed_{node},
        random{seed},
        axis{motion::Slide{1, model::FrictionLaw{{2.5, 4.5}, model::shape::constant(1)}, {0, start_m, 0}}},
        controller_side_{bus_.add_port()},
        port{controller_side_, seed},
        tool_{bus_.add_port()},
        absolute_{node.axes[0].drive.absolute_encoder},
        drive_node_{bus_.add_port(), drive_config(absolute_), axis} {
    drive().power_on({});
    start_controller();
  }
  FaultWorld(const FaultWorld&) = delete;
  FaultWorld& operator=(const FaultWorld&) = delete;

  // ---- time ----

  void step() {
    now_ += period;
    while (bus_.now() < now_) {
      bus_.advance_to(std::max(bus_.now(), next_event()));
      drive_node_.advance_to(bus_.now());
      if (twin_) twin_->advance_to(bus_.now());
    }
    drive().advance_mechanism_to(now_);
    if (each_period) each_period();
    command();
    port.begin_period(now_);
    if (!controller_runs) return;
    const testing::RealtimeGuard guard;
    node_->step(now_ + port.clock_ahead);
  }
  void run(hal::Duration duration) {
    for (const hal::Time end = now_ + duration; now_ < end;) step();
  }
  hal::Time now() const { return now_; }
  std::function<void()> each_period;  // what another tool does

  // ---- the controller ----

  bool controller_runs = true;
  // As after a power failure of its own.
  void start_controller() { node_.emplace(port, flashed_); }
  const auto& status() const { return node_->loop().status(*node_->loop().axis(0)); }
  const auto& master() const { return node_->loop().drive(*node_->loop().axis(0)); }
  firmware::AxisFault fault() const { return status().fault; }

  // ---- the commander ----

  bool commander_lives = true;
  firmware::MotionCommand wish{};

  // ---- the drive and its axis ----

  drive_emulator::DriveEmulator& drive() { return drive_node_.drive; }
  double force_N() const { return drive_node_.drive.force().at_N(hal::seconds(now_), 0, 0); }
  double target_m() const { return wish.target_counts * 1e-6; }
  bool holds() const { return status().running && status().output.mode == law::Mode::hold && axis.at_rest(); }
  // As the encoder shows it, and in truth.
  bool holds_shown_target() const {
    return holds() && std::abs(master().position_counts() - wish.target_counts) <= 1e6 * tolerance_m;
  }
  bool on_target() const { return holds() && std::abs(axis.true_position_m() - target_m()) <= tolerance_m; }

  // Another node of the same id, with an axis of its own at rest.
  void add_twin() {
    twin_axis_.emplace(motion::Slide{1, model::FrictionLaw{{20, 20}, model::shape::constant(1)}, {0, 0.05, 0}});
    twin_.emplace(bus_.add_port(), drive_config(absolute_), *twin_axis_);
    twin_->drive.power_on(bus_.now());
  }
  void remove_twin() {
    if (twin_) twin_->drive.set_silent(true);
  }

  // ---- another tool ----

  void send(const hal::CanFrame& frame) { static_cast<void>(tool_.send(frame, now_ + 10ms)); }
  // Over the bus, or through a service port of the drive that nobody on the bus sees.
  void write_to_drive(std::uint16_t index, std::uint8_t subindex, std::uint32_t value, std::uint8_t bytes) {
    hal::CanFrame frame{.id = canopen::sdo_request_cob_id(drive_id), .size = 8, .data = {}};
    frame.data[0] = static_cast<std::uint8_t>(0x23U | (4U - bytes) << 2);
    canopen::store_little_endian(frame.data, index, 1);
    frame.data[3] = subindex;
    canopen::store_little_endian(frame.data, value, 4);
    if (by_service_port)
      drive().on_frame(frame, now_);
    else
      send(frame);
  }
  bool by_service_port = false;

 private:
  static drive_emulator::EmulatorConfig drive_config(bool absolute) {
    drive_emulator::EmulatorConfig config;
    config.node_id = drive_id;
    config.rated_torque_mNm = 500;
    config.max_torque_per_mille = 4000;
    config.force_per_torque_N_per_Nm = 50;
    config.current_loop_time_constant_s = lag_s;
    config.quirks.counts_from_power_on = !absolute;
    return config;
  }

  hal::Time next_event() const {
    hal::Time next = std::min(now_, bus_.next_event());
    next = std::min(next, drive_node_.drive.next_event().value_or(now_));
    return twin_ ? std::min(next, twin_->drive.next_event().value_or(now_)) : next;
  }

  // A command is said again ten times a second, and when it changes.
  void command() {
    if (!commander_lives) return;
    const hal::CanFrame frame = firmware::encode_command(wish, flashed_.loop.network.node_id);
    if (frame == said_ && now_ - said_at_ < 100ms) return;
    said_ = frame;
    said_at_ = now_;
    send(frame);
  }

  const CampaignNode& flashed_;
  virtual_bus::VirtualBus bus_{{}};

 public:
  std::mt19937_64 random;
  TamperedAxis axis;

 private:
  BusPort& controller_side_;

 public:
  Port port;
  BusPort& controller_port() { return controller_side_; }

 private:
  BusPort& tool_;
  bool absolute_;
  BusNode drive_node_;
  std::optional<TamperedAxis> twin_axis_;
  std::optional<BusNode> twin_;
  std::optional<Node> node_;
  hal::Time now_{};
  hal::CanFrame said_{};
  hal::Time said_at_{};
};

}  // namespace breakaway::campaign
