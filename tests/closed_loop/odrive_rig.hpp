// One axis behind an emulated ODrive on a virtual bus under the flashed loop, in simulated time: the axis of rig.hpp.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>

#include "breakaway/odrive/drive.hpp"
#include "breakaway/odrive_emulator/odrive_emulator.hpp"
#include "rig.hpp"

namespace breakaway::closed_loop {

using OdriveLoop = firmware::ControlLoop<sil::SimulatedNetwork::Port, odrive::Drive<Real>, Controller, Real>;

struct OdriveRigConfig {
  hal::Duration period = 1ms;
  virtual_bus::VirtualBusConfig bus{};
  double start_m = -0.1;
  odrive::Estimates estimates = odrive::Estimates::cyclic;
  hal::Duration heartbeat_period = 100ms;
  Real max_force_N = 50;
  firmware::AxisLimits<Real> limits{};
  bool absolute_encoder = true;
  odrive_emulator::EmulatorConfig drive{};
};

inline OdriveRigConfig with(odrive::Estimates estimates, double clock_error = 0,
                            hal::Duration heartbeat_period = 100ms) {
  OdriveRigConfig config;
  config.estimates = estimates;
  config.drive.clock_error = clock_error;
  config.heartbeat_period = heartbeat_period;
  return config;
}

class OdriveRig {
 public:
  static constexpr double lag_s = 1e-4;                           // of its current loop
  static constexpr double travel_per_turn_m = 0.125663706143592;  // 2 pi / (50 N/Nm)

  explicit OdriveRig(const OdriveRigConfig& config)
      : config_{config},
        network_{config.bus},
        loop_{network_.controller_port(), {.network = {.period = config.period, .bit_rate = config.bus.bit_rate}}},
        mechanism_{motion::Slide{1, {{2.5, 4.5}, model::shape::constant(1)}, {0, config.start_m, 0}}} {
    law::AxisParameters<Real> p = Rig::parameters_for(config.period);
    p.max_force_N = config.max_force_N;
    table_ = design::build_k3_table<Real>({p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N},
                                          p.stick_radius_upper_m())
                 .table;
    pulses_ = design::design_pd_kicks(p, lag_s).table;
    odrive_emulator::EmulatorConfig emulated = config.drive;
    emulated.force_per_torque_N_per_Nm = 50;
    emulated.travel_per_turn_m = travel_per_turn_m;
    emulated.current_loop_time_constant_s = lag_s;
    emulated.heartbeat_period = config.heartbeat_period;
    emulated.counts_from_power_on = !config.absolute_encoder;
    if (config.estimates == odrive::Estimates::polled) emulated.estimate_period = emulated.torque_period = {};
    drive_ = &network_.add_drive(emulated, mechanism_);
    const odrive::DriveConfig<Real> master{.node_id = 1,
                                           .force_per_torque_N_per_Nm = 50,
                                           .max_torque_Nm = 1,
                                           .counts_per_turn = travel_per_turn_m / 1e-6,
                                           .estimates = config.estimates,
                                           .heartbeat_period = config.heartbeat_period,
                                           .heartbeat_timeout = config.heartbeat_period * 5 / 2,
                                           .absolute_encoder = config.absolute_encoder};
    const auto added = loop_.add_axis(master, {p, table_, pulses_}, config.limits);
    if (!added.id) std::abort();
    id_.emplace(*added.id);
  }

  void step() {
    now_ += config_.period;
    network_.advance_to(now_);
    loop_.step(now_);
    if (status().running && !mechanism_.released()) mechanism_.release(hal::seconds(now_));
    largest_N_ = std::max(largest_N_, std::abs(force_N()));
  }
  void run(hal::Duration duration) {
    for (const hal::Time end = now_ + duration; now_ < end;) step();
  }
  // False: it does not run within 10 s.
  bool start() {
    loop_.request_enable(*id_);
    while (now_ < hal::Time{10s} && !mechanism_.released()) step();
    return mechanism_.released();
  }
  // The time from now until the loop has a fault.
  hal::Duration time_until_fault(hal::Duration most) {
    const hal::Time begin = now_;
    while (status().fault == firmware::AxisFault::none && now_ - begin < most) step();
    return now_ - begin;
  }

  OdriveLoop& loop() { return loop_; }
  OdriveLoop::AxisId id() const { return *id_; }
  odrive_emulator::OdriveEmulator& drive() { return *drive_; }
  sil::SimulatedNetwork& network() { return network_; }
  double position_m() const { return mechanism_.position_m(); }
  double force_N() const { return drive_->force().at_N(hal::seconds(now_), 0, 0); }
  double largest_force_N() const { return drive_->largest_force_N(now_); }
  hal::Time now() const { return now_; }
  const firmware::AxisStatus<Real>& status() const { return loop_.status(*id_); }
  std::uint16_t fault_code() const { return loop_.supervisor(*id_).fault_code(); }
  bool at_rest() const { return mechanism_.slide().sticking(); }

 private:
  OdriveRigConfig config_;
  law::K3Table<Real> table_;
  law::KickTable<Real> pulses_;
  sil::SimulatedNetwork network_;
  OdriveLoop loop_;
  sil::BrakedSlide mechanism_;
  odrive_emulator::OdriveEmulator* drive_ = nullptr;
  std::optional<OdriveLoop::AxisId> id_;
  hal::Time now_{};
  double largest_N_ = 0;
};

inline std::string text_of(const OdriveRig& rig) { return std::string{odrive::fault_text(rig.fault_code())}; }

}  // namespace breakaway::closed_loop
