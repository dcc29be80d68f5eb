// Several axes behind emulated drives on one virtual bus under the flashed loop, in simulated time: for tests that look
// at more than the end of a run.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/design/pd_kicks.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/sil/braked_slide.hpp"
#include "breakaway/sil/simulated_network.hpp"

namespace breakaway::closed_loop {

using namespace std::chrono_literals;
using Real = float;
using Controller = law::AxisController<Real>;
using Loop = firmware::ControlLoop<sil::SimulatedNetwork::Port, cia402::Drive<Real>, Controller, Real>;

struct RigConfig {
  std::size_t axes = 1;
  hal::Duration period = 1ms;
  virtual_bus::VirtualBusConfig bus{};
  double start_m = -0.1;
  Real max_force_N = 50;
  double current_loop_time_constant_s = 1e-4;
  model::FrictionLaw friction{{2.5, 4.5}, model::shape::constant(1)};
  firmware::AxisLimits<Real> limits{};
  firmware::FaultScope fault_scope = firmware::FaultScope::axis;
  std::uint32_t supported_modes = cia402::supports_cyclic_torque | cia402::supports_homing;
  bool absolute_encoder = true;
  cia402::HomingConfig homing{};
  cia402::TorqueBase torque_base = cia402::TorqueBase::rated;
  std::uint16_t drive_max_torque_per_mille = 2000;
  canopen::EmcyCodes emcy_information{};
  bool user_position_unit = false;  // a count of the loop is a unit of the drive, whatever its encoder's are
  hal::Duration boot_duration = 5ms;
  drive_emulator::Quirks quirks{};
};

class Rig {
 public:
  explicit Rig(const RigConfig& config)
      : config_{config}, network_{config.bus}, loop_{network_.controller_port(), loop_config(config)} {
    const law::AxisParameters<Real> p = parameters();
    table_ = design::build_k3_table<Real>({p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N},
                                          p.stick_radius_upper_m())
                 .table;
    pulses_ = design::design_pd_kicks(p, config.current_loop_time_constant_s).table;
    for (std::size_t i = 0; i < config.axes; ++i) add_axis(static_cast<std::uint8_t>(i + 1), p);
  }

  static law::AxisParameters<Real> parameters_for(hal::Duration period) {
    law::AxisParameters<Real> p;
    p.mass_kg = 1;
    p.stiffness_N_per_m = 400;
    p.approach_damping_Ns_per_m = 32;
    p.kick_damping_Ns_per_m = 60;
    p.friction.lower_N = 2.5F;
    p.friction.upper_N = 4.5F;
    p.max_force_N = 50;
    p.max_approach_speed_m_s = 5;
    p.encoder_resolution_m = 1e-6F;
    p.period_s = std::chrono::duration<Real>(period).count();
    p.position_tolerance_m = p.accuracy_floor_m();
    return p;
  }
  law::AxisParameters<Real> parameters() const {
    law::AxisParameters<Real> p = parameters_for(config_.period);
    p.max_force_N = config_.max_force_N;
    return p;
  }

  // The simulated world up to the next step; then the flashed step itself; then the brakes of axes that start with it
  // open.
  void advance_world() {
    now_ += config_.period;
    network_.finish_period(loop_);
    network_.advance_to(now_);
  }
  void loop_step() { loop_.command(now_); }
  void release_brakes() {
    for (std::size_t i = 0; i < loop_.axes(); ++i) {
      if (status(i).running && !mechanisms_[i]->released()) mechanisms_[i]->release(hal::seconds(now_));
    }
  }
  // The brake is the drive's, which opens it as it begins to seek its home.
  void release_brakes_while_homing() {
    for (std::size_t i = 0; i < loop_.axes(); ++i) {
      const bool seeks = status(i).feedback.state == hal::DriveState::homing &&
                         drives_[i]->state() == cia402::State::operation_enabled;
      if (seeks && !mechanisms_[i]->released()) mechanisms_[i]->release(hal::seconds(now_));
    }
  }
  void step() {
    advance_world();
    loop_step();
    release_brakes();
  }
  void run(hal::Duration duration) {
    for (const hal::Time end = now_ + duration; now_ < end;) step();
  }
  // Sets the drives up and enables them. False: not all run within 10 s.
  bool start() {
    for (const Loop::AxisId id : ids_) loop_.request_enable(id);
    const auto released = [](const auto& mechanism) { return mechanism->released(); };
    while (now_ < hal::Time{10s} && !std::all_of(mechanisms_.begin(), mechanisms_.end(), released)) step();
    return std::all_of(mechanisms_.begin(), mechanisms_.end(), released);
  }
  // Largest |force| that the drive makes from now on within the duration.
  double largest_force_N(std::size_t axis, hal::Duration duration) {
    double largest = 0;
    for (const hal::Time end = now_ + duration; now_ < end;) {
      step();
      largest = std::max(largest, std::abs(force_N(axis)));
    }
    return largest;
  }

  // What another tool on the bus writes into the drive of an axis.
  void write_to_drive(std::uint16_t index, std::uint8_t subindex, std::uint32_t value, std::uint8_t bytes,
                      std::size_t axis = 0) {
    const auto node = static_cast<std::uint8_t>(axis + 1);
    hal::CanFrame frame{.id = canopen::sdo_request_cob_id(node), .size = 8, .data = {}};
    frame.data[0] = static_cast<std::uint8_t>(0x23U | (4U - bytes) << 2);
    canopen::store_little_endian(frame.data, index, 1);
    frame.data[3] = subindex;
    canopen::store_little_endian(frame.data, value, 4);
    drive(axis).on_frame(frame, now_);
  }

  Loop& loop() { return loop_; }
  Loop::AxisId id(std::size_t axis) const { return ids_[axis]; }
  drive_emulator::DriveEmulator& drive(std::size_t axis) { return *drives_[axis]; }
  sil::SimulatedNetwork& network() { return network_; }
  const motion::Slide& slide(std::size_t axis) const { return mechanisms_[axis]->slide(); }
  double position_m(std::size_t axis) const { return mechanisms_[axis]->position_m(); }
  double force_N(std::size_t axis) const { return drives_[axis]->force().at_N(hal::seconds(now_), 0, 0); }
  hal::Time now() const { return now_; }
  const firmware::AxisStatus<Real>& status(std::size_t axis) const { return loop_.status(ids_[axis]); }

 private:
  static firmware::LoopConfig loop_config(const RigConfig& config) {
    return {.network = {.period = config.period, .bit_rate = config.bus.bit_rate}, .fault_scope = config.fault_scope};
  }

  void add_axis(std::uint8_t node_id, const law::AxisParameters<Real>& p) {
    mechanisms_.push_back(
        std::make_unique<sil::BrakedSlide>(motion::Slide{p.mass_kg, config_.friction, {0, config_.start_m, 0}}));
    drive_emulator::EmulatorConfig emulated;
    emulated.node_id = node_id;
    emulated.rated_torque_mNm = 500;
    emulated.max_torque_per_mille = config_.drive_max_torque_per_mille;
    emulated.force_per_torque_N_per_Nm = 50;
    emulated.current_loop_time_constant_s = config_.current_loop_time_constant_s;
    emulated.supported_modes = config_.supported_modes;
    emulated.quirks = config_.quirks;
    emulated.boot_duration = config_.boot_duration;
    if (config_.user_position_unit && config_.quirks.feed_constant != 0)
      emulated.encoder_resolution_m *=
          config_.quirks.feed_constant / double{drive_emulator::encoder_counts_per_revolution};
    emulated.quirks.counts_from_power_on = !config_.absolute_encoder;
    drives_.push_back(&network_.add_drive(emulated, *mechanisms_.back()));

    cia402::DriveConfig<Real> master;
    master.node_id = node_id;
    master.force_per_torque_N_per_Nm = 50;
    master.absolute_encoder = config_.absolute_encoder;
    master.homing = config_.homing;
    master.torque_base = config_.torque_base;
    master.emcy_information = config_.emcy_information;
    master.user_position_unit = config_.user_position_unit;
    const auto added = loop_.add_axis(master, {p, table_, pulses_}, config_.limits);
    if (!added.id) std::abort();
    ids_.push_back(*added.id);
  }

  RigConfig config_;
  law::K3Table<Real> table_;
  law::KickTable<Real> pulses_;
  std::vector<std::unique_ptr<sil::BrakedSlide>> mechanisms_;
  sil::SimulatedNetwork network_;
  std::vector<drive_emulator::DriveEmulator*> drives_;
  Loop loop_;
  std::vector<Loop::AxisId> ids_;
  hal::Time now_{};
};

// Another master enables the drive by SDO and has it make 10 N.
inline void enable_from_elsewhere(Rig& rig, std::size_t axis = 0) {
  rig.write_to_drive(0x6060, 0, 10, 1, axis);
  rig.write_to_drive(0x6071, 0, 400, 2, axis);
  for (const std::uint32_t controlword : {0x06U, 0x07U, 0x0FU}) rig.write_to_drive(0x6040, 0, controlword, 2, axis);
}

inline RigConfig far_from_target() {
  RigConfig config;
  config.start_m = -1.0;  // full force for a while
  config.limits.speed_m_s = 20;
  config.limits.position_min_m = -2;
  config.limits.position_max_m = 2;
  return config;
}

// Steps until the loop has seen the fault; the number of steps that took.
inline int steps_until_fault(Rig& rig, int most) {
  int steps = 0;
  while (rig.status(0).fault == firmware::AxisFault::none && steps < most) {
    rig.step();
    ++steps;
  }
  return steps;
}

}  // namespace breakaway::closed_loop
