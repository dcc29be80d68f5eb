// Theorem U: both papers in one certificate of a machine whose axes push each other.
//
// A sampled PD brings the machine near its target: [A] says so, for the friction that sampling leaves. It is let go.
// Then Theorem S holds for every axis over the whole box in which it rests, and one axis after another is kicked to its
// accuracy, as [I] kicks a single one; no kick moves another axis, and none goes beyond. THEORY.md proves it.
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction"; [I] = the same, "Impulsive Control of Mechanical Motion Systems with Uncertain Friction".
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/sequential_kicks.hpp"

namespace breakaway::stability {

// The approach u_j = -P_j z_j - D_j (z_j - z_j of the sample before)/T, z the encoder's reading of q.
struct SampledApproach {
  Eigen::VectorXd position_gain_N_per_m;   // P
  Eigen::VectorXd velocity_gain_Ns_per_m;  // D
  Eigen::VectorXd start_m;                 // the approach starts at rest within |q_j| <= start_j
  Eigen::VectorXd resolution_m;            // one count of each encoder; 0: it reads q itself
  int latency_periods = 1;                 // from a sample to the first force computed from it
};

// How the hold of samples is bounded: what it takes of friction and of damping.
struct SampledMargin {
  Eigen::VectorXd lost_N;             // of the friction of each axis
  Eigen::VectorXd lost_Ns_per_m;      // of its damping
  Eigen::VectorXd acceleration_m_s2;  // the most of each axis on the way
  double start_J = 0;                 // V at the start, at most
  double level_J = 0;                 // below which V falls, for what is left of friction and damping
};

struct AxisPromise {
  double box_m = 0;              // |q| after the release, at most
  double gate_m = 0;             // a reading within this lets the release begin
  double kick_N = 0;             // the largest force of a kick; 0: the axis is held only
  double floor_m = 0;            // what a force that is sure to move the axis takes it, in one period, at most
  double least_tolerance_m = 0;  // of a reading
  std::uint32_t most_kicks = 0;
  KickedAxis kicked;
  PairCondition tightest;  // of all conditions of Theorem S on its kicks
};

struct MachineCertificate {
  bool certified = false;
  std::string reason;  // why not: the condition, with the pair where there is one, its margin and the remedy
  std::vector<Condition> conditions;
  SampledMargin sampled;
  std::vector<AxisPromise> axes;
  std::vector<PairCondition> simultaneous;  // which pairs could not be kicked at once, and by how much; informs only
  std::uint32_t most_kicks = 0;             // of all axes together
  double release_s = 0;                     // from the release to certain rest, at most
};

// The most periods that the force of one kick lasts.
inline constexpr std::uint8_t most_kick_periods = 255;
// After so many time constants a current loop has all but exp(-7) of its change behind it.
inline constexpr double lags_to_nothing = 7;
// The approach counts as still after so many periods without more than one count of change.
inline constexpr std::uint8_t still_periods = 8;

// `tolerance_m`: of the reading of each axis, to which kicks lead. Throws InputError as require_valid(), and for sizes.
// What is examined comes to its end at the first step that nothing can be said after; `reason` names the first failure.
MachineCertificate certify_machine(const CoupledAxes& axes, const SampledApproach& approach,
                                   const Eigen::VectorXd& tolerance_m);

// The pulse that aims at a distance with at most kick_N: as few periods as do, and one less where its force would not
// be sure to move the axis. law::KickCoordinator computes the same.
struct KickPulse {
  double force_N;
  std::uint8_t periods;
};

KickPulse kick_pulse(const KickedAxis& axis, double kick_N, double aim_m, double period_s);

// How far that pulse takes the axis at least.
double sure_travel_m(const KickedAxis& axis, double kick_N, double aim_m, double period_s);

}  // namespace breakaway::stability
