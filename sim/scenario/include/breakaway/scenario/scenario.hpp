// Scenario: a node as its file describes it, and the world around it. A simulation pays only for the parts that the
// file names: without [loop] and [drive] it is the ideal law on the bare plant.
//
// SI units; a rotary axis reads kg m^2, N m and rad for kg, N and m. Ranges of all members stand in the readers
// of firmware/config and of this room.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/model/compliant_plant.hpp"
#include "breakaway/model/encoder_error.hpp"
#include "breakaway/model/friction_drift.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/odrive_emulator/config.hpp"
#include "breakaway/stability/linear_machine.hpp"
#include "breakaway/virtual_bus/virtual_bus.hpp"

namespace breakaway::scenario {

using config::unlimited;

// A machine that all axes stand on, and where it starts.
struct CoupledMachine {
  stability::LinearMachine<> machine;
  stability::MachineState<Eigen::Dynamic> start;  // at time 0
};

// An axis' place in the machine of n coordinates q: its force u acts as push u, and its encoder reads read . q.
struct MachinePlace {
  Eigen::VectorXd push, read;  // n
};

// What is true of an axis and its node is not told: a rigid axis on dry friction with a perfect encoder, unless the
// file says otherwise.
struct AxisWorld {
  double position_m = 0;  // at time 0
  double velocity_m_s = 0;
  model::FrictionLaw friction{{1, 1}, model::shape::constant(1)};  // between the true bounds
  model::CompliantPlant plant{};  // all of it but mass_kg and the gap; the mass is config::truth_of(axis).mass_kg
  double gap_m = 0;               // of the backlash between the motor and plant.load
  bool encoder_on_load = false;   // it sits on the motor otherwise
  std::optional<model::FrictionDrift> drift;
  std::optional<model::EncoderErrorParameters> encoder_error;
  std::optional<MachinePlace> place;  // in Scenario::machine, which then stands in place of friction and plant
  std::optional<drive_emulator::EmulatorConfig> drive;    // of protocol "canopen"
  std::optional<odrive_emulator::EmulatorConfig> odrive;  // of protocol "odrive"
  std::optional<double> tolerance;  // of the integration of its motion, for one step; none: the finest
};

enum class ScalarType : std::uint8_t { float32, float64 };

struct Run {
  double duration_s = 0;
  double settle_time_s = 0;  // the error must stay within the tolerance, at rest, for this long
  bool stop_when_settled = true;
  std::optional<double> accuracy_m;  // the error that the position of any axis may have at the end
};

struct Scenario {
  config::Node node;
  std::vector<AxisWorld> worlds;          // one for each axis of the node
  std::optional<CoupledMachine> machine;  // that the axes share; none: each moves alone
  std::optional<virtual_bus::VirtualBusConfig> bus;
  ScalarType scalar = ScalarType::float32;  // what the loop computes in; the ideal law always takes double
  std::optional<Run> run;

  bool ideal() const noexcept { return !node.loop; }
  std::size_t axes() const noexcept { return node.axes.size(); }
};

// The scenario with one of its axes alone. Throws InputError when none has the name, or they share a machine.
Scenario only_axis(const Scenario& scenario, const std::string& name);

}  // namespace breakaway::scenario
