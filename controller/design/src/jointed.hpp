// A motor and a load on a spring: what is worst of their class for a kick that ends by its work.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "breakaway/design/pulse_work.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "work_trial.hpp"

namespace breakaway::design::detail {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

// The class with its worst masses and forces.
struct Jointed {
  explicit Jointed(const BrakedClass& c)
      : axes{c},
        load{*c.spring_load},
        K{load.stiffness_N_per_m},
        G{load.gap_m},
        M{load.motor_kg + load.load_kg},
        heavier{2 * c.mass_kg.most / (c.mass_kg.least + c.mass_kg.most)},
        lighter{2 * c.mass_kg.least / (c.mass_kg.least + c.mass_kg.most)},
        A1{load.motor_friction.lower_N - c.load_N},
        A2{load.load_friction.lower_N},
        B1{load.motor_friction.upper_N + c.load_N},
        B2{load.load_friction.upper_N},
        Bs{std::min(B1, B2)},
        g{A1 + A2} {}

  double spring_m() const {
    const double other_N = load.encoder_on_load ? A1 : A2;
    return ((Bs + other_N) * (Bs + other_N) / (2 * K) + other_N * G) / g;
  }

  // How far the spring may lead the side that is read once that was seen to rest, if friction falls then. No pulse does
  // any work, so that Theorem E has it within eps; and an axis that reads a count and a half more is kicked again.
  // Where that side alone holds all that the spring can pull, it stays.
  double creep_m() const {
    const double read_N = load.encoder_on_load ? A2 : A1;
    return Bs > read_N ? std::min(spring_m(), counts_to_leave_hold * unseen_m()) : 0;
  }

  double rest_s() const {
    const bool on_load = load.encoder_on_load;
    const double hidden_kg = heavier * (on_load ? load.motor_kg : load.load_kg), hidden_N = on_load ? A1 : A2;
    const double swings = 1 + std::ceil(std::max(((on_load ? B2 : B1) / hidden_N - 1) / 2, 0.0));
    return std::sqrt(2 * unseen_m() * heavier * M / g) + pi * std::sqrt(hidden_kg / K) * swings +
           std::sqrt(2 * swings * G * hidden_kg / hidden_N) + rest_within_a_count_s() + more_periods * axes.period_s;
  }

  double unseen_m() const { return axes.encoder_resolution_m + 4 * axes.encoder_noise_m; }

  // For how long the side that is read may swing within a count: beside the other one, which sticks, or against it.
  // Each half a swing takes twice the friction over K off its height. A stiffer joint swings more often.
  double rest_within_a_count_s() const {
    const bool on_load = load.encoder_on_load;
    const double read_kg = on_load ? load.load_kg : load.motor_kg, read_N = on_load ? A2 : A1;
    const double hidden_kg = on_load ? load.motor_kg : load.load_kg, hidden_N = on_load ? A1 : A2;
    const double stiffest = most_stiffer * K, held_N = unseen_m() * stiffest / 4;
    const double beside = held_N / read_N * std::sqrt(read_kg);
    const double against =
        held_N * M * M / (hidden_kg * (hidden_N * read_kg + read_N * hidden_kg)) * std::sqrt(read_kg * hidden_kg / M);
    return pi * std::sqrt(heavier / stiffest) * std::max(beside, against);
  }

  double swing_s() const { return 1 / load.resonance_Hz(); }

  // The least command that is sure to move the load in so many periods.
  double least_N(int periods) const {
    const double angle = std::min(std::sqrt(K / (heavier * load.motor_kg)) * periods * axes.period_s, pi / 2);
    const double force_N = sure_share * std::max(B1 + B2, B1 - Bs + (B2 + Bs) / (1 - std::cos(angle)));
    return force_N / axes.force_gain.least + axes.force_step_N;
  }

  // The command with which a rigid axis goes as far as y - eps, and no further than that before its motion is seen.
  // A meter may let a pulse be stronger: then it is at least the sure one.
  double force_N(double y_m, int periods) const {
    const double way_m = y_m - spring_m(), t = periods * axes.period_s;
    if (!(way_m > 0)) return 0;
    if (load.encoder_on_load) return unmetered_force_N(way_m, t) / axes.force_gain.most;
    double force = (g + std::sqrt(g * g + 8 * lighter * M * g * way_m / (t * t))) / 2;
    force = std::max(force, least_N(periods) * axes.force_gain.most);
    return std::min(force, unseen_force_N(way_m, std::min(periods, blind_periods()))) / axes.force_gain.most;
  }

  double late_periods() const {
    return axes.latency_periods + 1 + 2 * (axes.lag_s.most + axes.jitter_s) / axes.period_s;
  }

  // The least travel of the encoder's side in a kick, of some, however the spring is bent when they start; under
  // friction that is constant for each way and of either side its least, its greatest or between. The meter allows for
  // readings that show a count too little, and these show one too much.
  double least_travel_m(double y_m, double command_N, int periods, double enough_m) const {
    const double gained_m = std::max(axes.force_gain.most * command_N - held_back_N(), 0.0) * axes.period_s *
                            axes.period_s / (lighter * load.motor_kg);
    const double late = late_periods();
    WorkTrial trial{.motor_kg = heavier * load.motor_kg,
                    .load_kg = heavier * load.load_kg,
                    .stiffness_N_per_m = K,
                    .gap_m = G,
                    .motor_friction = {B1, B1},
                    .load_friction = {B2, B2},
                    .period_s = axes.period_s,
                    .latency_periods = axes.latency_periods,
                    .metered = !load.encoder_on_load,
                    .encoder_on_load = load.encoder_on_load,
                    .most_travel_m = g * (y_m - spring_m()) / (axes.force_gain.most * command_N) -
                                     2 * unseen_m() * (1 + late) - gained_m * (late + late * late) / 2,
                    .late_periods = late,
                    .bent_m = 0};
    double least_m = least_of_bends_m(trial, axes.force_gain.least * command_N, periods, enough_m);
    if (least_m < enough_m) return least_m;
    if (trial.metered) {
      if (!(lighter < heavier) && !(axes.force_gain.least < axes.force_gain.most)) return least_m;
      // The faster a motor is, the sooner the meter ends its pulse.
      trial.motor_kg = lighter * load.motor_kg;
      trial.load_kg = lighter * load.load_kg;
      return std::min(least_m, least_of_bends_m(trial, axes.force_gain.most * command_N, periods, enough_m));
    }
    for (const double times : stiffer_joints) {
      trial.stiffness_N_per_m = times * K;
      least_m = std::min(least_m, least_of_bends_m(trial, axes.force_gain.least * command_N, periods, enough_m));
      if (least_m < enough_m) return least_m;
    }
    return least_m;
  }

  // A kick that does nothing leaves the spring bent as it was, and so do all that follow it: no bend may let one.
  double least_of_bends_m(WorkTrial trial, double force_N, int periods, double enough_m) const {
    double least_m = infinite;
    for (const auto& [of_motor, of_load] : shares) {
      trial.motor_friction = {A1 + of_motor.towards_N * (B1 - A1), A1 + of_motor.back_N * (B1 - A1)};
      trial.load_friction = {A2 + of_load.towards_N * (B2 - A2), A2 + of_load.back_N * (B2 - A2)};
      const double ahead_N = std::min(trial.motor_friction.back_N, trial.load_friction.towards_N);
      const double behind_N = std::min(trial.motor_friction.towards_N, trial.load_friction.back_N);
      for (const double bent : bends) {
        trial.bent_m = bent * (bent > 0 ? ahead_N : behind_N) / trial.stiffness_N_per_m + std::copysign(G / 2, bent);
        const auto end = trial.run(force_N, periods);
        least_m = std::min(least_m, load.encoder_on_load ? end.load_m : end.motor_m);
        if (least_m < enough_m) return least_m;
      }
    }
    return least_m;
  }

  int blind_periods() const { return axes.latency_periods + 1; }
  // What the spring cannot have added to a pulse, of the force that acts.
  double held_back_N() const { return A1 - Bs; }

  const BrakedClass& axes;
  const SpringLoad& load;
  double K, G, M, heavier, lighter, A1, A2, B1, B2, Bs, g;

 private:
  static constexpr double pi = std::numbers::pi;
  static constexpr double sure_share = 1.002;  // by which a pulse exceeds what it has to
  static constexpr double more_periods = 8;    // in which a swing may show the same count by chance
  static constexpr double counts_to_leave_hold = 1.5;

  // Of the way from the least friction to the greatest.
  struct Shares {
    WorkTrial::Friction of_motor, of_load;
  };
  // Without a meter a pulse is whole swings of the told stiffness only.
  static constexpr std::array<double, 2> stiffer_joints{2, 6};
  static constexpr std::array<Shares, 6> shares{
      {{{1, 1}, {1, 1}}, {{1, 0}, {1, 0}}, {{1, 0}, {1, 1}}, {{0, 0}, {1, 1}}, {{1, 1}, {0, 0}}, {{0, 0}, {0, 0}}}};
  // Of what both sides hold; which is ahead where the bend is above 0.
  static constexpr std::array<double, 5> bends{1, -1, 0.6, 0.3, 0};

  // Of the force that acts: whose work is at most what friction takes on the way. More than the drive has is not told
  // apart.
  double unmetered_force_N(double way_m, double pulse_s) const {
    const PulseWork pulse{.motor_kg = lighter * load.motor_kg,
                          .load_kg = lighter * load.load_kg,
                          .stiffness_N_per_m = K,
                          .gap_m = G,
                          .motor_friction_N = A1,
                          .load_friction_N = A2,
                          .held_N = Bs,
                          .lag_s = axes.lag_s.most};
    double lawful_N = g, more_N = 1.01 * axes.force_gain.most * axes.max_force_N;
    if (!(pulse.most_J(lawful_N, pulse_s) <= g * way_m)) return 0;
    if (pulse.most_J(more_N, pulse_s) <= g * way_m) return more_N;
    for (int halving = 0; halving < 60; ++halving) {
      const double between_N = (lawful_N + more_N) / 2;
      (pulse.most_J(between_N, pulse_s) <= g * way_m ? lawful_N : more_N) = between_N;
    }
    return lawful_N;
  }

  // F (F - h) t^2 / (2 m1) = g way
  double unseen_force_N(double way_m, int periods) const {
    const double t = periods * axes.period_s + 2 * axes.lag_s.most, h = held_back_N();
    const double product = 2 * lighter * load.motor_kg * g * way_m / (t * t);
    return std::max((h + std::sqrt(h * h + 4 * product)) / 2, 0.0);
  }
};

}  // namespace breakaway::design::detail
