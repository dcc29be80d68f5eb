// The node that is flashed for coupled_gantry.toml, commanded over the virtual bus, with emulated drives on its
// machine: whatever stands between them may be made to fail.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <random>
#include <type_traits>
#include <vector>

#include "../../campaign/tampered_port.hpp"
#include "../../realtime_guard.hpp"
#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"
#include "flashed_node.hpp"

namespace breakaway::emulated {

inline constexpr std::size_t axes = flashed::node.capacity;

// What an encoder shows of the truth, which it may misread.
class ShownEncoder final : public drive_emulator::Mechanism {
 public:
  explicit ShownEncoder(drive_emulator::Mechanism& truth) : truth_{truth} {}
  std::function<double(double)> shown{};
  void advance_to(double time_s, const model::AppliedForce& force) override { truth_.advance_to(time_s, force); }
  void change_force(const model::AppliedForce& force) override { truth_.change_force(force); }
  double position_m() const override { return shown ? shown(truth_.position_m()) : truth_.position_m(); }
  double true_m() const { return truth_.position_m(); }

 private:
  drive_emulator::Mechanism& truth_;
};

// The node with the drives and the machine of its scenario, and a commander that says each axis' wish when it changes,
// and ten times a second.
class FlashedGantry {
 public:
  using Port = campaign::TamperedPort<sil::SimulatedNetwork::Port>;

  explicit FlashedGantry(std::uint64_t seed) : random{seed}, port{network_.controller_port(), seed} {
    for (std::size_t i = 0; i < axes; ++i) {
      encoders.emplace_back(mechanisms_[i].seen_by_drive());
      drive_emulator::EmulatorConfig config = *scene_.worlds[i].drive;
      config.max_torque_per_mille *= 2;  // the drive could do twice what its axis may
      drives_.push_back(&network_.add_drive(config, encoders[i]));
    }
  }

  firmware::NodeVerdict verdict() const { return node_.verdict(); }
  const auto& status(std::size_t i) const { return node_.loop().status(*node_.loop().axis(i)); }
  const auto& master(std::size_t i) const { return node_.loop().drive(*node_.loop().axis(i)); }
  const auto& coordinator() const { return node_.loop().controller(*node_.loop().axis(0)).coordinator(); }

  void step() {
    now_ += flashed::node.loop.network.period;
    network_.advance_to(now_);
    if (each_period) each_period();
    for (std::uint8_t i = 0; i < axes; ++i) {
      wish[i].axis = i;
      const hal::CanFrame frame = firmware::encode_command(wish[i], flashed::node.loop.network.node_id);
      if (frame != said_[i] || (now_ - hal::Time{}) % std::chrono::milliseconds{100} == hal::Duration{}) send(frame);
      said_[i] = frame;
    }
    port.begin_period(now_);
    if (!controller_runs) return;
    {
      const testing::RealtimeGuard guard;
      node_.step(now_);
    }
    if (!released_ && status(0).running && status(1).running) {
      released_ = true;
      for (auto& mechanism : mechanisms_) mechanism.axis->release(hal::seconds(now_));
    }
  }
  void run(hal::Duration duration) {
    for (const hal::Time end = now_ + duration; now_ < end;) step();
  }
  hal::Time now() const { return now_; }

  bool faulty() const {
    return status(0).fault != firmware::AxisFault::none || status(1).fault != firmware::AxisFault::none;
  }
  bool holds() const {
    return status(0).running && status(1).running && coordinator().phase() == law::CoordinatorPhase::hold &&
           coordinator().end() == law::CoordinatorEnd::on_target && at_rest();
  }
  bool at_rest() const {
    return !released_ || (mechanisms_[0].axis->state().sticking && mechanisms_[1].axis->state().sticking);
  }
  drive_emulator::DriveEmulator& drive(std::size_t i) { return *drives_[i]; }
  double position_m(std::size_t i) const { return mechanisms_[i].axis->state().position_m; }
  std::int32_t counts(std::size_t i) const { return static_cast<std::int32_t>(std::lround(position_m(i) * 1e6)); }
  double error_m(std::size_t i) const { return position_m(i) - wish[i].target_counts * 1e-6; }
  double force_N(std::size_t i) const { return drives_[i]->force().at_N(hal::seconds(now_), 0, 0); }

  void send(const hal::CanFrame& frame) { static_cast<void>(tool_.send(frame, now_ + std::chrono::milliseconds{10})); }
  // Over the bus, or through a service port of the drive that nobody on the bus sees.
  void write(std::size_t i, bool seen, std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned bytes) {
    hal::CanFrame frame{.id = canopen::sdo_request_cob_id(static_cast<std::uint8_t>(i + 1)), .size = 8, .data = {}};
    frame.data[0] = static_cast<std::uint8_t>(0x23U | (4U - bytes) << 2);
    canopen::store_little_endian(frame.data, index, 1);
    frame.data[3] = sub;
    canopen::store_little_endian(frame.data, value, 4);
    if (seen)
      send(frame);
    else
      drive(i).on_frame(frame, now_);
  }
  void bus_state(hal::BusState state) { network_.controller_port().set_bus_state(state); }

  std::mt19937_64 random;
  std::function<void()> each_period;
  bool controller_runs = true;
  std::array<firmware::MotionCommand, axes> wish{};

 private:
  scenario::Scenario scene_ = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/coupled_gantry.toml");
  std::vector<sil::AxisMechanism> mechanisms_ = sil::axis_mechanisms(scene_);
  sil::SimulatedNetwork network_{*scene_.bus};
  sil::SimulatedNetwork::Port& tool_ = network_.add_port();
  std::vector<drive_emulator::DriveEmulator*> drives_;
  hal::Time now_{};
  std::array<hal::CanFrame, axes> said_{};
  bool released_ = false;

 public:  // members are made in this order
  std::deque<ShownEncoder> encoders;
  Port port;

 private:
  firmware::ControlNode<Port, std::remove_const_t<decltype(flashed::node)>> node_{port, flashed::node};
};

}  // namespace breakaway::emulated
