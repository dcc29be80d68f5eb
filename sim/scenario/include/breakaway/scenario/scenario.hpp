// Scenario: one axis, what drives it and what it shall do. A scene pays only for the parts that it names: without
// [loop], [drive] and [bus] it is the ideal law on the bare plant.
//
// [I]: van de Wouw and Leine, Impulsive Control of Mechanical Motion Systems with Uncertain Friction. SI units; a
// rotary axis reads kg m^2, N m and rad for kg, N and m. Ranges of all members stand in read_scenario.cpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/virtual_bus/virtual_bus.hpp"

namespace breakaway::scenario {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

struct Plant {
  double mass_kg = 0;
  double position_m = 0;  // at time 0
  double velocity_m_s = 0;
};

// What the controller is designed for (Assumption 1 of [I]), and the law that really acts between these bounds.
struct Friction {
  double lower_N = 1;
  double upper_N = 1;
  double smooth_slope_Ns_per_m = 0;        // dF_sm/dv at rest of Proposition 3
  std::optional<double> normal_force_N{};  // m g where the file states coefficients: pictures then show coefficients
  model::FrictionLaw law{{1, 1}, model::shape::constant(1)};
};

enum class Kick : std::uint8_t { ideal, two_phase, naive };
enum class ScalarType : std::uint8_t { float32, float64 };

// Gains of the switching impulsive law (16).
struct ImpulsiveGains {
  double stiffness_N_per_m = 0;          // k1
  double approach_damping_Ns_per_m = 0;  // k21
  double kick_damping_Ns_per_m = 0;      // k22
  Kick kick = Kick::ideal;
};

struct PidGains {
  double proportional_N_per_m = 0;
  double integral_N_per_ms = 0;
  double derivative_Ns_per_m = 0;
};

struct TargetChange {
  double time_s = 0;
  double position_m = 0;
};

struct Controller {
  std::optional<ImpulsiveGains> impulsive;  // exactly one of impulsive and pid is there
  std::optional<PidGains> pid;
  double max_force_N = unlimited;
  double max_approach_speed_m_s = unlimited;
  double position_tolerance_m = 0;
  ScalarType scalar = ScalarType::float32;  // what the loop computes in; the ideal law always takes double
  double target_m = 0;
  std::vector<TargetChange> targets;  // in order of time
};

struct Loop {
  double period_s = 0;
};

// What the supervisor stops the axis for; absent: unlimited.
struct Limits {
  double position_m = unlimited;  // |position|
  double speed_m_s = unlimited;
  double following_error_m = unlimited;
};

struct Run {
  double duration_s = 0;
  double settle_tolerance_m = 0;
  double settle_time_s = 0;  // the error must stay within the tolerance, at rest, for this long
  bool stop_when_settled = true;
};

struct Scenario {
  std::string file;  // where it was read from, for errors
  std::string title;
  Plant plant;
  Friction friction;
  Controller controller;
  std::optional<Loop> loop;
  std::optional<drive_emulator::EmulatorConfig> drive;
  std::optional<virtual_bus::VirtualBusConfig> bus;
  Limits limits;
  std::optional<Run> run;

  bool ideal() const noexcept { return !loop; }
};

// The most that the drive's motor gives at the axis.
inline double drive_force_N(const drive_emulator::EmulatorConfig& drive) {
  const double torque_Nm = 1e-6 * drive.max_torque_per_mille * drive.rated_torque_mNm;
  return std::min(torque_Nm * drive.force_per_torque_N_per_Nm, drive.peak_force_N.value_or(unlimited));
}

// The parameters of the flashed law for this scene. Requires controller.impulsive.
template <class Real>
law::AxisParameters<Real> axis_parameters(const Scenario& s) {
  const ImpulsiveGains& gains = *s.controller.impulsive;
  law::AxisParameters<Real> p;
  p.mass_kg = static_cast<Real>(s.plant.mass_kg);
  p.stiffness_N_per_m = static_cast<Real>(gains.stiffness_N_per_m);
  p.approach_damping_Ns_per_m = static_cast<Real>(gains.approach_damping_Ns_per_m);
  p.kick_damping_Ns_per_m = static_cast<Real>(gains.kick_damping_Ns_per_m);
  p.friction.lower_N = static_cast<Real>(s.friction.lower_N);
  p.friction.upper_N = static_cast<Real>(s.friction.upper_N);
  p.max_force_N = static_cast<Real>(s.controller.max_force_N);
  p.max_approach_speed_m_s = static_cast<Real>(s.controller.max_approach_speed_m_s);
  p.position_tolerance_m = static_cast<Real>(s.controller.position_tolerance_m);
  p.encoder_resolution_m = static_cast<Real>(s.drive ? s.drive->encoder_resolution_m : 0.0);
  p.period_s = static_cast<Real>(s.loop ? s.loop->period_s : 0.0);
  p.kick_shape = gains.kick == Kick::naive ? law::KickShape::naive : law::KickShape::two_phase;
  return p;
}

}  // namespace breakaway::scenario
