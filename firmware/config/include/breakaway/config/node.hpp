// Node: a controller node and its axes, described once. What is flashed, started, checked, certified or simulated
// comes from here; where each number stands in the file is said by the readers in src, one row each.
//
// [I]: van de Wouw and Leine, Impulsive Control of Mechanical Motion Systems with Uncertain Friction. SI units; a
// rotary axis reads kg m^2, N m and rad for kg, N and m.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/cia402/homing_config.hpp"
#include "breakaway/cia402/torque_scale.hpp"
#include "breakaway/config/data_sheet.hpp"
#include "breakaway/design/spring_load.hpp"
#include "breakaway/firmware/fault_scope.hpp"
#include "breakaway/firmware/moves_end.hpp"
#include "breakaway/firmware/wiring.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/friction_bounds.hpp"
#include "breakaway/odrive/drive_config.hpp"
#include "breakaway/odrive/torque_grid.hpp"

namespace breakaway::config {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

// The friction that the axis is designed for (Assumption 1 of [I]).
struct Friction {
  law::FrictionBounds<double> bounds{1, 1};
  double smooth_slope_Ns_per_m = 0;         // dF_sm/dv at rest of Proposition 3
  double presliding_stiffness_N_per_m = 0;  // before it slides it is a spring, at least as stiff; 0: it holds at once
  std::optional<double> normal_force_N{};   // m g where the file states coefficients: pictures then show coefficients
};

enum class Kick : std::uint8_t { ideal, two_phase, naive };

// How far what the file says may be from the truth. Kicks under the coast "brake" are made for all of it.
struct Uncertainty {
  double mass = 0;                        // relative, either way
  double force_gain = 0;                  // relative, either way: of the force that acts to the one that is commanded
  double force_N = 0;                     // either way: of a force beside the drive's
  double current_loop_time_constant = 0;  // relative, either way
  double jitter_s = 0;                    // by which samples and new forces are off whole periods, one against another
  double encoder_noise_m = 0;             // by which a reading is off beside half a count, either way
};

// Gains of the switching impulsive law (16).
struct ImpulsiveGains {
  double stiffness_N_per_m = 0;          // k1
  double approach_damping_Ns_per_m = 0;  // k21
  double kick_damping_Ns_per_m = 0;      // k22
  Kick kick = Kick::ideal;
  law::Coast coast = law::Coast::pd;  // brake, where a file with [loop] and [drive] names none, nor the naive kick
  double feedforward_N = 0;           // as the file has it, before it is rounded to a step of the drive
  bool fine_stage = true;             // coast "brake": where the tolerance is below the floor, kicks that may go beyond
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
  double position_tolerance_m = 0;    // at rest within this the axis is left alone; 0: never
  double target_m = 0;                // at the start
  std::vector<TargetChange> targets;  // in the order of time
};

// How an axis with an incremental encoder gets its zero.
struct Homing {
  cia402::Home home = cia402::Home::none;
  double position_m = 0;  // of home
  // The rest is for a drive that finds its home by itself; what is not given is the drive's own.
  std::int8_t method = 37;  // 6098h
  std::optional<double> speed_m_s{}, zero_speed_m_s{}, acceleration_m_s2{};
  hal::Duration timeout{std::chrono::seconds{60}};
};

// It stands at home when it is set up; the drive's methods 35 and 37 say so, too.
constexpr bool begins_at_home(const Homing& h) {
  return h.home == cia402::Home::here || (h.home == cia402::Home::by_drive && (h.method == 35 || h.method == 37));
}

enum class Protocol : std::uint8_t { canopen, odrive };

// What only a drive of protocol "odrive" has.
struct Odrive {
  double travel_per_turn_m = 1;  // of what its position is in turns of
  double max_torque_Nm = 1;      // of the motor
  // Its limits are told to the drive where both are given.
  std::optional<double> torque_constant_Nm_per_A{}, velocity_limit_turns_s{};
  odrive::Estimates estimates = odrive::Estimates::cyclic;
  hal::Duration estimate_period{std::chrono::milliseconds{1}};  // of cyclic ones
  double rounding_m = 0;  // half a step of its float where the axis may go; a part of encoder_noise_m
};

// The drive on the bus, as the file describes it.
struct Drive {
  std::uint8_t node_id = 1;
  std::uint32_t rated_torque_mNm = 1000;                       // 6076h
  std::uint32_t rated_current_mA = 1000;                       // 6075h
  std::uint16_t max_torque_per_mille = 3000;                   // 6072h
  std::optional<double> peak_force_N{};                        // what the motor gives at most, where that is less
  double force_per_torque_N_per_Nm = 1;                        // transmission: 1 / lever
  double encoder_resolution_m = 1e-6;                          // one count of 6064h
  double current_loop_time_constant_s = 0;                     // first-order lag from demand to force
  cia402::TorqueBase torque_base = cia402::TorqueBase::rated;  // what a target torque counts in
  bool user_position_unit = false;  // one count is the drive's own unit of position, not its encoder's
  bool invert_direction = false;    // the drive's positive direction is the axis' negative one
  bool absolute_encoder = false;    // its counts mean the same after a reboot of the drive
  Homing homing;                    // of an encoder that is not absolute
  hal::Duration heartbeat_period{std::chrono::milliseconds{100}};   // of the drive's heartbeat
  hal::Duration heartbeat_timeout{std::chrono::milliseconds{250}};  // after which either side misses the other
  hal::Duration sdo_timeout{std::chrono::milliseconds{50}};         // for one answer
  canopen::EmcyCodes emcy_information{};                            // of messages that are no errors
  std::shared_ptr<const DataSheet> data_sheet{};                    // what its maker says; nothing: no file was given

  std::optional<Odrive> odrive;  // absent: the protocol is "canopen", and the rated and the largest torque are above

  Protocol protocol() const { return odrive ? Protocol::odrive : Protocol::canopen; }
  // The least step of force at the axis: of one per mille of the rated torque, or of the grid of an ODrive's.
  double force_quantum_N() const {
    if (odrive) return odrive->max_torque_Nm / odrive::torque_steps * force_per_torque_N_per_Nm;
    return 1e-6 * rated_torque_mNm * force_per_torque_N_per_Nm;
  }
  // The most that the motor gives at the axis.
  double max_force_N() const {
    const double steps = odrive ? odrive::torque_steps : max_torque_per_mille;
    return std::min(steps * force_quantum_N(), peak_force_N.value_or(unlimited));
  }
};

// How a target is approached, under the coast "brake".
struct Move {
  double distance_m = 0;  // the longest; it says what is certified, and the law is not told of it
  double speed_m_s = 0;
  double acceleration_m_s2 = 0;
  std::optional<double> jerk_m_s3{};
};

// The supervisor stops the axis when it leaves these.
struct Limits {
  double position_min_m = -unlimited;
  double position_max_m = unlimited;
  double speed_m_s = unlimited;
  double force_N = unlimited;  // of the force that the drive reports
  double following_error_m = unlimited;
  std::optional<hal::Duration> feedback_timeout{};  // age of the newest sample; nothing: two and a half periods
};

// What is true of an axis whose file tells its node something else, in [told].
struct Truth {
  double mass_kg = 0;
  law::FrictionBounds<double> bounds{1, 1};
  double force_per_torque_N_per_Nm = 1;
};

// Of friction that bends before it slides; 0: it holds at once.
struct Bristles {
  double stiffness_N_per_m = 0;
  double damping_Ns_per_m = 0;
};

// That a drive takes from SYNC to its answer where the file says nothing else.
inline constexpr double usual_feedback_delay_s = 20e-6;

// What the file says of the world of an axis, as far as its certificate must know it. A node is not told of it.
struct Surroundings {
  double force_N = 0;    // constant, on the axis beside the drive's force and friction
  double cogging_N = 0;  // the most of it
  double ripple = 0;     // share of the drive's force by which it varies along the travel
  Bristles bristles{};
  double gap_m = 0;            // of a backlash between motor and load
  double drift = 0;            // share of itself by which friction swells and falls
  double rise_per_m_s = 0;     // of the friction law with speed, at its steepest, where 1 is from bound to bound
  double encoder_error_m = 0;  // of a reading beside its count; of noise six times its root mean square
  double feedback_delay_s = usual_feedback_delay_s;  // from SYNC to the drive's answer, at most
  bool one_mass = true;  // the axis is what [plant] mass_kg and [friction] say, and nothing hangs on it
  std::optional<design::SpringLoad> load;  // but for the motor, which is the axis of [plant] and [friction]
  std::vector<std::string> uncertified;    // what no certificate takes in, each in a sentence with its remedy
};

// The same of the bus.
struct BusSurroundings {
  double loss_probability = 0;
  double least_delay_s = 0, most_delay_s = 0;  // of a frame
};

// What the node is told of an axis. Where the file has a table [told], that is what stands here, and the truth beside
// it is for the simulation.
struct Axis {
  std::string name;  // unique in the node
  double mass_kg = 0;
  Friction friction;
  Uncertainty uncertainty;
  Controller controller;
  std::optional<Drive> drive;
  std::optional<Move> move;
  Limits limits;
  std::uint8_t latency_periods = 1;  // from taking a sample to the first force computed from it
  std::optional<Truth> truth;        // where the file has [told]
  Surroundings surroundings;
};

struct Loop {
  hal::Duration period{};
  std::uint8_t node_id = 127;  // the node's own on the bus
  hal::Duration heartbeat_period{std::chrono::milliseconds{50}};
  firmware::FaultScope fault_scope = firmware::FaultScope::axis;
  firmware::MovesEnd moves_end = firmware::MovesEnd::each;
  hal::Duration command_timeout{std::chrono::milliseconds{500}};  // of a node that another one commands
};

// What a node is told of how its axes push each other: their coordinates are those of the machine, in the order of the
// file. Where there is one, the axes are approached together and kicked one after another (law/kick_coordinator.hpp).
struct Coupling {
  Eigen::MatrixXd mass;            // kg; its diagonal is mass_kg of the axes
  double mass_error = 0;           // relative, of every entry, either way
  double mass_slope_kg_per_m = 0;  // by which an entry may change with any coordinate, at most
  double range_m = unlimited;      // from the target, in which the masses are so
  Eigen::MatrixXd damping;         // N s/m
  Eigen::MatrixXd stiffness;       // N/m
  Eigen::VectorXd load_N;          // other forces on each axis, either way
  double start_m = 0;              // from rest to a target, at most, of each axis
};

struct Node {
  std::string file;  // where it was read from, for errors
  std::string title;
  std::optional<Loop> loop;               // absent: the ideal law, which nothing samples
  std::optional<std::uint32_t> bit_rate;  // of the bus; present where there is a drive
  BusSurroundings bus_surroundings;
  firmware::Wiring wiring;           // of the board, where the node runs on a microcontroller
  double settle_tolerance_m = 0;     // [run]: within which true error an axis counts as settled; 0: see below
  std::vector<Axis> axes;            // at least one
  std::optional<Coupling> coupling;  // of the axes, where they push each other

  double period_s() const { return loop ? std::chrono::duration<double>(loop->period).count() : 0; }
};

// The law holds to a reading, which is off the truth by this at most: half a count, and noise where it is stated.
inline double reading_error_m(const Axis& axis) {
  return axis.drive ? axis.drive->encoder_resolution_m / 2 + axis.uncertainty.encoder_noise_m : 0;
}

// The share of the stated noise that is rounding, the same at the same place.
inline double rounding_m(const Axis& axis) {
  return axis.drive && axis.drive->odrive ? axis.drive->odrive->rounding_m : 0;
}

// The tolerance of the reading that the law holds to, and that is flashed and certified: position_tolerance_m, or else
// what keeps the true error within settle_tolerance_m.
inline double tolerance_m(const Node& node, const Axis& axis) {
  if (axis.controller.position_tolerance_m > 0 || !node.loop) return axis.controller.position_tolerance_m;
  const double reading_m = node.settle_tolerance_m - reading_error_m(axis);
  return reading_m > 0 ? reading_m : node.settle_tolerance_m;
}

// The true error that is promised and judged.
inline double judged_tolerance_m(const Node& node, const Axis& axis) {
  return node.settle_tolerance_m > 0 ? node.settle_tolerance_m : tolerance_m(node, axis) + reading_error_m(axis);
}

// What is true of the axis, whatever its node is told.
inline Truth truth_of(const Axis& axis) {
  return axis.truth.value_or(
      Truth{axis.mass_kg, axis.friction.bounds, axis.drive ? axis.drive->force_per_torque_N_per_Nm : 1.0});
}

// How much more force the node believes in than its drive makes: told 1.1, the axis gets 1/1.1 of what is commanded.
inline double told_force_gain(const Axis& axis) {
  return axis.drive ? axis.drive->force_per_torque_N_per_Nm / truth_of(axis).force_per_torque_N_per_Nm : 1.0;
}

// Returns one line of what the node is told that differs from the truth, as "mass_kg 1.2 (truly 1)"; nothing where the
// file has no [told].
std::string told_otherwise(const Axis& axis);

}  // namespace breakaway::config
