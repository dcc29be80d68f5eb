// Runs of the flashed law on a simulated axis, and what is kept of each: how long it took and how it ended, its kicks,
// how far it went, and its force over time. Campaigns of many thousand axes have tested what a design promises of this
// law; of one that behaves otherwise they say nothing. Who changes it on purpose runs them again, and then takes over
// the lines that the tests of recorded_runs_test.cpp print.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <random>
#include <string>

#include "../../kicked_axis.hpp"
#include "../../recorded_figures.hpp"
#include "law_fixture.hpp"

namespace breakaway::law::testing {

// To the last hold or the fault; that began; at the end, twice; of the axis at the end; past the target from where it
// was kicked; in that mode; of the force's size, of the force with its time, and of its square; of the speed that the
// law sees; that the last kick showed.
struct Figures {
  double periods = 0, kicks = 0, mode = 0, fault = 0, error_counts = 0, beyond_counts = 0, approach_s = 0;
  double force_Ns = 0, lever_Ns2 = 0, square_N2s = 0, seen_m = 0, friction_N = 0;

  std::array<double, 12> all() const {
    return {periods,    kicks,    mode,      fault,      error_counts, beyond_counts,
            approach_s, force_Ns, lever_Ns2, square_N2s, seen_m,       friction_N};
  }
  Figures mirrored() const {
    Figures other = *this;
    other.error_counts = -error_counts;
    other.lever_Ns2 = -lever_Ns2;
    return other;
  }
};

inline void expect_recorded(const std::string& run, const Figures& now) {
  static const recorded::RecordedFigures kept{BREAKAWAY_SOURCE_DIR "/tests/unit/law/recorded_runs.csv", 6};
  kept.expect(run, now.all());
}

// What is seen and told beside the positions of the axis.
struct Circumstances {
  int latency_periods = 1;
  double longest_s = 3;
  int hold_periods = 60;
  double encoder_offset = 0;
  int lost_each = 0;     // of so many samples one is lost
  int noise_counts = 0;  // of a reading, either way
  double told_m = 0;     // the target moves on by so much,
  double pushed_m = 0;   // or the axis is put elsewhere,
  int at_period = -1;    // in this period
  double limited_N = 0;  // from that period on the drive gives no more; 0: as before
  double take_s = 0;     // the move from the start is to take so long
  bool reset = false;    // in that period the law is reset
};

template <class Real, class Kicks, class Axis>
Figures recorded_run(const AxisParameters<Real>& p, const K3Table<Real>& k3, const Kicks& kicks, Axis axis,
                     const Circumstances& c) {
  AxisController<Real, Kicks> controller{p, k3, kicks};
  const double start_m = axis.position_m();
  const double q = static_cast<double>(p.encoder_resolution_m), T = static_cast<double>(p.period_s);
  if (c.take_s > 0) controller.take_time(static_cast<Real>(c.take_s), static_cast<Real>(std::fabs(start_m)));
  std::mt19937_64 bits{7};
  std::deque<std::optional<double>> samples;
  Figures f;
  double target_m = 0, shown_m = 0, kicked_from_m = start_m;
  int held = 0;
  for (long k = 0; static_cast<double>(k) * T < c.longest_s && held < c.hold_periods; ++k) {
    if (k == c.at_period) {
      target_m = std::round(c.told_m / q) * q;
      if (target_m != 0) controller.shift_target(static_cast<Real>(target_m));
      shown_m = std::round(c.pushed_m / q) * q;
      if (c.limited_N > 0) controller.limit_force(static_cast<Real>(c.limited_N));
      if (c.reset) controller.reset();
    }
    const double noise = c.noise_counts > 0 ? static_cast<double>(bits() % 3) - 1 : 0;
    samples.emplace_back(std::round(axis.position_m() / q + c.encoder_offset) - c.encoder_offset +
                         noise * c.noise_counts);
    if (c.lost_each > 0 && bits() % static_cast<unsigned>(c.lost_each) == 0) samples.back().reset();
    while (samples.size() > static_cast<std::size_t>(c.latency_periods) + 1) samples.pop_front();
    const std::optional<double>& seen = samples.front();
    const double error_m = seen.value_or(0) * q - target_m + shown_m;
    const auto out = controller.update({static_cast<Real>(error_m), 0, seen.has_value()});
    if (out.kicked) ++f.kicks, kicked_from_m = axis.position_m() - target_m;
    const double force_N = static_cast<double>(out.force_N), t = static_cast<double>(k) * T;
    axis.run(force_N, T, 2);
    f.force_Ns += std::fabs(force_N) * T;
    f.lever_Ns2 += force_N * t * T;
    f.square_N2s += force_N * force_N * T;
    f.seen_m += std::fabs(static_cast<double>(controller.velocity_m_s())) * T;
    expect_nothing_with_a_fault(controller, out);
    if (out.mode == Mode::approach) f.approach_s += T;
    const double way_m = (axis.position_m() - target_m) * (kicked_from_m > 0 ? -1 : 1);
    if (k >= c.at_period) f.beyond_counts = std::max(f.beyond_counts, way_m / q);
    held = out.mode == Mode::hold && k >= c.at_period ? held + 1 : 0;
    if (held == 0) f.periods = static_cast<double>(k + 1);
    if (out.mode == Mode::fault && k >= c.at_period) break;
  }
  f.mode = static_cast<double>(controller.mode());
  f.fault = static_cast<double>(controller.fault());
  f.error_counts = (axis.position_m() - target_m) / q;
  f.friction_N = static_cast<double>(controller.seen_friction_N());
  return f;
}

}  // namespace breakaway::law::testing
