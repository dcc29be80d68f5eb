#include "breakaway/design/pulse_work.hpp"

#include <algorithm>
#include <cmath>

namespace breakaway::design {
namespace {

// What a body travels at most in a time if its energy is at most the force times its travel and something more.
double driven_m(double mass_kg, double force_N, double more_J, double time_s) {
  return force_N * time_s * time_s / (2 * mass_kg) + time_s * std::sqrt(2 * more_J / mass_kg);
}

}  // namespace

// While the force still rises, less of it than F is there against a motor that goes back.
double PulseWork::late_J(double force_N) const {
  const double spared_N = force_N - 2 * motor_friction_N;
  if (!(spared_N > 0) || !(lag_s > 0)) return 0;
  const double time_s = lag_s * std::log(force_N / (2 * motor_friction_N));
  return spared_N * driven_m(motor_kg, force_N, strained_J(), time_s);
}

// The most that a spring and its gap give to what is pulled apart by pulled_N.
double PulseWork::given_J(double force_N, double pulled_N) const {
  const double both_N = pulled_N + held_N;
  return both_N * both_N / (2 * stiffness_N_per_m) + pulled_N * gap_m + late_J(force_N);
}

double PulseWork::most_travel_m(double force_N, double pulse_s) const {
  const double both_kg = motor_kg + load_kg, share = load_kg / both_kg;
  const double left_N = force_N - motor_friction_N - load_friction_N;
  const double alone_m = driven_m(motor_kg, left_N, given_J(force_N, load_friction_N), pulse_s);
  // Of the centre of mass, and what the motor may be ahead of it.
  const double pulled_N = left_N * share + load_friction_N, more_J = given_J(force_N, pulled_N);
  const double centre_m = driven_m(both_kg, left_N, more_J, pulse_s);
  const double ahead_m =
      gap_m + (pulled_N + held_N) / stiffness_N_per_m + std::sqrt(2 * (left_N * centre_m + more_J) / stiffness_N_per_m);
  return std::min(alone_m, centre_m + share * ahead_m);
}

double PulseWork::most_J(double force_N, double pulse_s) const {
  const double travel_m = most_travel_m(force_N, pulse_s), late = late_J(force_N), left_Ns = force_N * lag_s;
  const double energy_J = strained_J() + (force_N - motor_friction_N) * travel_m + late;
  const double dying_J = left_Ns * std::sqrt(2 * energy_J / motor_kg) + left_Ns * left_Ns / (2 * motor_kg);
  return force_N * travel_m + late + dying_J;
}

}  // namespace breakaway::design
