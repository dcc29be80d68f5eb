// An axis of which an experiment knows nothing, on the plant of kicked_axis.hpp: mass, friction that varies with place,
// direction and speed, a current loop that lags, latency and counts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <numbers>
#include <random>

#include "breakaway/evaluation/identification.hpp"
#include "breakaway/identify/experiment.hpp"
#include "kicked_axis.hpp"

namespace breakaway::testing {

struct UnknownAxis {
  double mass_kg = 1, friction_N = 3, max_force_N = 50, force_step_N = 0.025;
  double period_s = 1e-3, resolution_m = 1e-6, lag_s = 0, load_N = 0;
  int latency_periods = 1;
  double lowest_m = -0.25, highest_m = 0.25, start_m = 0, max_speed_m_s = 2;
  double wave = 0.1, wave_length_m = 0.5, phase = 0;  // of friction over the place
  double tilt = 0.05;                                 // of friction between the directions, either way
  double rise_at_rest = 0, stribeck_m_s = 0.01;       // of friction where it is slow

  double friction_at(double position_m, int direction, double speed_m_s) const {
    const double place = wave * std::sin(2 * std::numbers::pi * position_m / wave_length_m + phase);
    const double slow = rise_at_rest * std::exp(-std::abs(speed_m_s) / stribeck_m_s);
    return friction_N * (1 + place + tilt * direction + slow);
  }
  evaluation::Interval true_friction_N() const {
    evaluation::Interval all{1e300, 0};
    for (int i = 0; i <= 1000; ++i) {
      const double x = lowest_m + (highest_m - lowest_m) * i / 1000;
      for (const int direction : {-1, 1}) {
        all.least = std::min(all.least, friction_at(x, direction, max_speed_m_s));
        all.most = std::max(all.most, friction_at(x, direction, 0));
      }
    }
    return all;
  }
};

template <class Scalar>
identify::ExperimentParameters<Scalar> told(const UnknownAxis& axis) {
  const auto as_told = [](double value) { return static_cast<Scalar>(value); };
  return {.period_s = as_told(axis.period_s),
          .encoder_resolution_m = as_told(axis.resolution_m),
          .force_step_N = as_told(axis.force_step_N),
          .max_force_N = as_told(axis.max_force_N),
          .lowest_m = as_told(axis.lowest_m),
          .highest_m = as_told(axis.highest_m),
          .max_speed_m_s = as_told(axis.max_speed_m_s)};
}

struct ExperimentRun {
  evaluation::Record record;
  identify::Ending ending{};
  double lowest_m = 0, highest_m = 0, fastest_m_s = 0, duration_s = 0, speed_at_end_m_s = 0;
};

// What may happen on the way.
struct Trouble {
  double end_asked_s = 1e9;
  double lost_share = 0;  // of the samples
  double late_s = 0;      // the most by which a period begins late: sample and force alike
  double late_share = 1;  // of the periods
  std::uint64_t seed = 1;
};

// Plant: Slider, or what moves as it does; the other side of a plant of two is followed where it is given.
template <class Scalar, class Plant>
ExperimentRun run_experiment_on(Plant& plant, const identify::ExperimentParameters<Scalar>& told, int latency_periods,
                                const Trouble& trouble = {}, const double* out_of_sight_m = nullptr) {
  identify::Experiment<Scalar> experiment{told};
  const double start_m = plant.position_m(), period_s = static_cast<double>(told.period_s);
  const double resolution_m = static_cast<double>(told.encoder_resolution_m);
  ExperimentRun run{.record = {period_s, resolution_m, static_cast<double>(told.force_step_N), {}},
                    .lowest_m = start_m,
                    .highest_m = start_m};
  std::deque<double> on_the_way(static_cast<std::size_t>(latency_periods), start_m);
  std::mt19937_64 dice{trouble.seed};
  const auto share = [&] { return std::uniform_real_distribution<>{0, 1}(dice); };
  const auto late_s = [&] {
    return trouble.late_s > 0 && share() < trouble.late_share ? trouble.late_s * share() : 0.0;
  };
  double begun_late_s = 0;
  for (int k = 0; !experiment.finished() && k < 100'000; ++k) {
    if (run.duration_s >= trouble.end_asked_s) experiment.request_end();
    const double reading_m = std::round(on_the_way.front() / resolution_m) * resolution_m;
    on_the_way.pop_front();
    const bool fresh = share() >= trouble.lost_share;
    const law::Measurement<Scalar> measured{static_cast<Scalar>(reading_m), Scalar{0}, fresh};
    const auto command_N = static_cast<double>(experiment.update(measured).force_N);
    run.record.readings.push_back({reading_m, command_N, fresh});
    // The sample of the next period is taken when this one's force begins to act.
    on_the_way.push_back(plant.position_m());
    const double next_late_s = late_s();
    plant.run(command_N, period_s + next_late_s - begun_late_s, 4);
    begun_late_s = next_late_s;
    for (const double position_m : {plant.position_m(), out_of_sight_m ? *out_of_sight_m : plant.position_m()}) {
      run.lowest_m = std::min(run.lowest_m, position_m);
      run.highest_m = std::max(run.highest_m, position_m);
    }
    run.fastest_m_s = std::max(run.fastest_m_s, std::abs(plant.velocity_m_s()));
    run.duration_s += period_s;
  }
  run.speed_at_end_m_s = plant.velocity_m_s();
  run.ending = experiment.ending();
  return run;
}

template <class Scalar = double>
ExperimentRun run_experiment(const UnknownAxis& axis, const Trouble& trouble = {}) {
  const auto friction = [&](const Moment& now) {
    const double v = now.velocity_m_s;
    return axis.friction_at(now.position_m, (v != 0 ? v : now.force_N) < 0 ? -1 : 1, v);
  };
  Slider slider{{.mass_kg = axis.mass_kg, .lag_s = axis.lag_s, .load_N = axis.load_N}, friction, axis.start_m, 0};
  return run_experiment_on(slider, told<Scalar>(axis), axis.latency_periods, trouble);
}

}  // namespace breakaway::testing
