#include "pd_trial.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <vector>

#include "breakaway/design/pd_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/law/rest_detector.hpp"
#include "rubbed_mass.hpp"

namespace breakaway::design::detail {
namespace {

constexpr double surely = 1.05;      // of what the approach was seen to do: a float, and friction that changes
constexpr double by_a_kick = 0.002;  // of the way from where friction may hold the axis goes a kick beyond the target
constexpr double longer = 4;         // of the kicks: in trials of fewer places two axes took 2.6 times what was seen

constexpr double endless = std::numeric_limits<double>::infinity();

double least_friction_N(const AxisDesign& axis) { return axis.friction.lower_N - axis.force_step_N / 2; }
double most_friction_N(const AxisDesign& axis) { return axis.friction.upper_N + axis.force_step_N / 2; }

// What all trials of an axis have in common.
struct TrialContext {
  const AxisDesign& axis;
  const law::K3Table<float>& k3;
  const law::KickTable<float>& pulses;
  long periods_left = most_tried_periods;
};

// The flashed law on an axis under constant friction, which comes from below.
class Trial {
 public:
  Trial(TrialContext& context, double friction_N, double distance_m)
      : axis_{context.axis},
        periods_left_{context.periods_left},
        controller_{parameters_of_pd(axis_), context.k3, context.pulses},
        mass_{axis_.mass_kg, friction_N, -distance_m} {}

  // While `goes_on` says so of the controller. Returns how long that was; infinite where it did not end.
  template <class GoesOn>
  double run(const GoesOn& goes_on) {
    for (long k = 0; periods_left_ > 0; ++k, --periods_left_) {
      if (!goes_on(controller_)) return static_cast<double>(k) * axis_.period_s;
      samples_.push_back(measured());
      note_progress(std::abs(samples_.back().position_error_m));
      const auto waiting = static_cast<std::size_t>(axis_.latency_ticks) + 1;
      if (samples_.size() > waiting) samples_.pop_front();
      const auto wanted_N = static_cast<double>(controller_.update(samples_.front()).force_N);
      force_N_ = mass_.push_behind_lag(force_N_, wanted_N, axis_.current_loop_lag_s, axis_.period_s);
    }
    return endless;
  }

  const RubbedMass& mass() const noexcept { return mass_; }
  // In which it was read no nearer to its target than ever before, at most.
  double without_progress_s() const noexcept { return static_cast<double>(most_idle_) * axis_.period_s; }
  const law::AxisController<float>& controller() const noexcept { return controller_; }

 private:
  law::Measurement<float> measured() const {
    const double q = axis_.encoder_resolution_m;
    const double read_m = q > 0 ? std::round(mass_.position_m() / q) * q : mass_.position_m();
    return {static_cast<float>(read_m), static_cast<float>(mass_.velocity_m_s()), true};
  }

  void note_progress(float error_m) noexcept {
    idle_ = error_m < least_error_m_ ? 0 : idle_ + 1;
    least_error_m_ = std::min(least_error_m_, error_m);
    most_idle_ = std::max(most_idle_, idle_);
  }

  const AxisDesign& axis_;
  long& periods_left_;
  law::AxisController<float> controller_;
  RubbedMass mass_;
  std::deque<law::Measurement<float>> samples_;
  double force_N_ = 0;  // behind the current loop
  float least_error_m_ = std::numeric_limits<float>::max();
  long idle_ = 0, most_idle_ = 0;  // periods
};

// From which on an approach from further away is no faster: the way on which the speed is reached that is allowed, and
// that on which the spring slows it down.
double far_m(const AxisDesign& axis) {
  const double speed_m_s = axis.max_approach_speed_m_s, k21 = axis.approach_damping_Ns_per_m;
  if (!std::isfinite(speed_m_s)) return endless;
  const double spare_N = std::min(axis.max_force_N, k21 * speed_m_s) - axis.friction.lower_N;
  const double speeding_m = axis.mass_kg * speed_m_s * speed_m_s / spare_N + 10 * speed_m_s * axis.mass_kg / k21;
  return k21 * speed_m_s / axis.stiffness_N_per_m + speeding_m;
}

// For a way at the least speed that the limit of its own leaves the axis: friction takes f / k21 of it.
double further_s(const AxisDesign& axis, double way_m) {
  if (!(way_m > 0)) return 0;
  return way_m / (axis.max_approach_speed_m_s - axis.friction.upper_N / axis.approach_damping_Ns_per_m);
}

// Of the approach, which friction that changes may let swing once more.
double half_swing_s(const AxisDesign& axis) {
  const double zeta = damping_ratio(axis.mass_kg, axis.stiffness_N_per_m, axis.approach_damping_Ns_per_m);
  return std::numbers::pi / std::sqrt(axis.stiffness_N_per_m / axis.mass_kg * (1 - zeta * zeta));
}

// Within half a step of where friction may hold the axis the drive may give less than the friction that the spring
// exceeds. There the axis stands until it is taken for stuck, or creeps on as an overdamped one does.
double creeping_s(const AxisDesign& axis) {
  if (!(axis.force_step_N > 0)) return 0;
  const double band_m = axis.force_step_N / 2 / axis.stiffness_N_per_m;
  const double slow_s = axis.approach_damping_Ns_per_m / axis.stiffness_N_per_m;
  return slow_s * std::log1p(band_m / axis.encoder_resolution_m) +
         2 * law::RestDetector<float>::patience * axis.period_s;
}

bool is_approached(const law::AxisController<float>& law) { return law.mode() == law::Mode::approach; }
bool is_under_way(const law::AxisController<float>& law) {
  return law.mode() != law::Mode::hold && law.mode() != law::Mode::fault;
}

// How long a kick takes under the least friction, which lets it go furthest, up to the hold; of the next distance up
// of a geometric grid, so that each is tried once.
class KickTimes {
 public:
  KickTimes(TrialContext& context, double furthest_m) : context_{context}, furthest_m_{furthest_m} {}

  double of_kick_from(double distance_m) {
    const double steps = std::log(distance_m / furthest_m_) / std::log(step);
    const auto i = static_cast<std::size_t>(std::clamp(steps, 0.0, static_cast<double>(most - 1)));
    if (times_s_[i] < 0)
      times_s_[i] = Trial{context_, least_friction_N(context_.axis), furthest_m_ * std::pow(step, i)}.run(is_under_way);
    return times_s_[i];
  }

 private:
  static constexpr double step = 0.7;
  static constexpr std::size_t most = 100;

  TrialContext& context_;
  double furthest_m_;
  std::vector<double> times_s_ = std::vector<double>(most, -1);
};

struct Kicks {
  int count;  // more than the law gives where the run ends by name
  double time_s;
};

// As many as under the greatest friction, each of which takes as long as under the least.
Kicks kicks_from(TrialContext& context, KickTimes& times, double distance_m) {
  Trial trial{context, most_friction_N(context.axis), distance_m};
  std::uint32_t kicks = 0;
  double time_s = 0;
  const double ends_s = trial.run([&](const law::AxisController<float>& law) {
    if (law.kicks() > kicks) {
      kicks = law.kicks();
      time_s += times.of_kick_from(std::abs(trial.mass().position_m()));
    }
    return is_under_way(law);
  });
  const bool fails = trial.controller().mode() == law::Mode::fault;
  return {fails ? law::KickJudge<float>::most_kicks + 1 : static_cast<int>(kicks),
          std::isfinite(ends_s) ? time_s : endless};
}

// Where nothing limits the speed nothing is said but how long the axis may come no nearer, from far enough to pass its
// target.
void try_approach(TrialContext& context, PdPromise& promise) {
  const AxisDesign& axis = context.axis;
  const double far = far_m(axis), longest_m = axis.longest_way_m > 0 ? axis.longest_way_m : far;
  const bool is_limited = std::isfinite(std::min(longest_m, far));
  const double way_m = is_limited ? std::min(longest_m, far) : 100 * axis.friction.upper_N / axis.stiffness_N_per_m;
  Trial least{context, least_friction_N(axis), way_m}, most{context, most_friction_N(axis), way_m};
  const double time_s = std::max(least.run(is_approached), most.run(is_approached));
  promise.is_tried = std::isfinite(time_s);
  if (!promise.is_tried) return;
  promise.left_m = std::max(std::abs(least.mass().position_m()), std::abs(most.mass().position_m()));
  const double more_s = half_swing_s(axis) + creeping_s(axis);
  promise.without_progress_s = surely * std::max(least.without_progress_s(), most.without_progress_s()) + more_s;
  if (!is_limited) return;
  const double passed_m = std::max(least.mass().furthest_m(), 0.0);
  promise.beyond_m = surely * passed_m + axis.position_tolerance_m + 2 * axis.encoder_resolution_m;
  promise.approach_peak_m_s = surely * least.mass().fastest_m_s();
  promise.longest_way_m = longest_m;
  promise.approach_s = surely * (time_s + further_s(axis, longest_m - way_m)) + more_s;
}

template <class Real>
law::AxisParameters<Real> parameters_in(const AxisDesign& axis) {
  law::AxisParameters<Real> p;
  p.mass_kg = static_cast<Real>(axis.mass_kg);
  p.stiffness_N_per_m = static_cast<Real>(axis.stiffness_N_per_m);
  p.approach_damping_Ns_per_m = static_cast<Real>(axis.approach_damping_Ns_per_m);
  p.kick_damping_Ns_per_m = static_cast<Real>(axis.kick_damping_Ns_per_m);
  p.friction = {static_cast<Real>(axis.friction.lower_N), static_cast<Real>(axis.friction.upper_N)};
  p.max_force_N = static_cast<Real>(axis.max_force_N);
  p.max_approach_speed_m_s = static_cast<Real>(axis.max_approach_speed_m_s);
  p.position_tolerance_m = static_cast<Real>(axis.position_tolerance_m);
  p.encoder_resolution_m = static_cast<Real>(axis.encoder_resolution_m);
  p.period_s = static_cast<Real>(axis.period_s);
  p.latency_periods = static_cast<std::uint8_t>(axis.latency_ticks);
  return p;
}

// Of so many that were seen: from between the places that are tried, under less friction, and under some that changes.
int unseen_kicks(int seen) { return 2 + seen / 10; }

// Where one sequence of kicks begins a little nearer than another, each of its kicks does, and may just reach the
// tolerance or just not: that is tried from many places. From further away than friction may hold the axis an approach
// leads it there, which is kicked as it creeps, and then needs more kicks than one that rests.
void try_kicks(TrialContext& context, PdPromise& promise) {
  constexpr int nearer = 24, further = 12;
  constexpr double nearest = 0.3, furthest = 10;  // of where friction may hold the axis
  const AxisDesign& axis = context.axis;
  const double stuck_m = axis.friction.upper_N / axis.stiffness_N_per_m;
  const double longest_m = axis.longest_way_m > 0 ? std::max(axis.longest_way_m, stuck_m) : endless;
  KickTimes times{context, stuck_m};
  const auto try_from = [&](double share) {
    const Kicks kicks = kicks_from(context, times, std::min(share * stuck_m, longest_m));
    promise.most_kicks = std::max(promise.most_kicks, kicks.count + unseen_kicks(kicks.count));
    promise.kicks_s = std::max(promise.kicks_s, longer * kicks.time_s);
    promise.is_tried = promise.is_tried && std::isfinite(kicks.time_s);
  };
  for (int i = 0; i < nearer; ++i) try_from(std::pow(nearest, static_cast<double>(i) / nearer));
  for (int i = 1; i <= further; ++i) try_from(1 + (furthest - 1) * std::pow(static_cast<double>(i) / further, 3));
}

// By the steps of the force; without them a kick ends on the target, but for what is known of the table.
double kicked_beyond_m(const AxisDesign& axis, const law::KickTable<float>& pulses, double stuck_m) {
  if (!(axis.force_step_N > 0)) return 0;
  auto p = parameters_in<double>(axis);
  p.friction.lower_N = least_friction_N(axis);
  double beyond_m = 0;
  for (const double share : {1.0, 0.7, 0.4, 0.15, 0.05}) {
    const double from_m = share * stuck_m;
    const auto pulse = pulses.pulse(static_cast<float>(std::sqrt(from_m)));
    const double force_N = static_cast<double>(pulse.force_N);
    beyond_m = std::max(beyond_m, pd_travel_m(p, axis.current_loop_lag_s, from_m, force_N, pulse.periods) - from_m);
  }
  return surely * beyond_m;
}

}  // namespace

law::AxisParameters<float> parameters_of_pd(const AxisDesign& axis) { return parameters_in<float>(axis); }

int most_tried_kicks() noexcept { return law::KickJudge<float>::most_kicks * 4 / 5; }

PdPromise try_pd(const AxisDesign& axis, const law::K3Table<float>& k3) {
  const PdKicks<float> made = design_pd_kicks(parameters_of_pd(axis), axis.current_loop_lag_s);
  TrialContext context{axis, k3, made.table};
  const double stuck_m = axis.friction.upper_N / axis.stiffness_N_per_m;
  PdPromise promise{.beyond_m = endless,
                    .approach_peak_m_s = endless,
                    .most_kicks = 0,
                    .aim_lost = made.aim_lost,
                    .error_m = axis.position_tolerance_m + axis.encoder_resolution_m / 2,
                    .longest_way_m = 0,
                    .approach_s = 0,
                    .kicks_s = 0,
                    .without_progress_s = 0,
                    .left_m = 0,
                    .is_tried = false};
  try_approach(context, promise);
  if (!promise.is_tried) return promise;
  promise.beyond_m = std::max(
      {promise.beyond_m, by_a_kick * stuck_m, made.beyond * stuck_m, kicked_beyond_m(axis, made.table, stuck_m)});
  try_kicks(context, promise);
  promise.without_progress_s += promise.kicks_s;
  return promise;
}

}  // namespace breakaway::design::detail
