#include "pd_trial.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "breakaway/design/pd_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "rubbed_mass.hpp"

namespace breakaway::design::detail {
namespace {

constexpr double surely = 1.05;      // of what the approach was seen to do: a float, and friction that changes
constexpr double by_a_kick = 0.002;  // of the way from where friction may hold the axis goes a kick beyond the target
constexpr long most_periods = 4'000'000;  // of a trial

struct PdTables {
  const law::K3Table<float>& k3;
  const law::KickTable<float>& pulses;
};

// The flashed law on an axis under constant friction, which comes from below.
class Trial {
 public:
  Trial(const AxisDesign& axis, const PdTables& tables, double friction_N, double distance_m)
      : axis_{axis},
        controller_{parameters_of_pd(axis), tables.k3, tables.pulses},
        mass_{axis.mass_kg, friction_N, -distance_m} {}

  // While `goes_on` says so of the controller.
  template <class GoesOn>
  void run(const GoesOn& goes_on) {
    // A lagging current loop owes as much as if each force began a time constant later.
    const double lag_s = std::min(axis_.current_loop_lag_s, axis_.period_s);
    for (long k = 0; k < most_periods && goes_on(controller_); ++k) {
      samples_.push_back(measured());
      const auto waiting = static_cast<std::size_t>(axis_.latency_ticks) + 1;
      if (samples_.size() > waiting) samples_.pop_front();
      const double before_N = force_N_;
      force_N_ = static_cast<double>(controller_.update(samples_.front()).force_N);
      mass_.push(before_N, lag_s);
      mass_.push(force_N_, axis_.period_s - lag_s);
    }
  }

  const RubbedMass& mass() const noexcept { return mass_; }
  const law::AxisController<float>& controller() const noexcept { return controller_; }

 private:
  law::Measurement<float> measured() const {
    const double q = axis_.encoder_resolution_m;
    const double read_m = q > 0 ? std::round(mass_.position_m() / q) * q : mass_.position_m();
    return {static_cast<float>(read_m), static_cast<float>(mass_.velocity_m_s()), true};
  }

  const AxisDesign& axis_;
  law::AxisController<float> controller_;
  RubbedMass mass_;
  std::deque<law::Measurement<float>> samples_;
  double force_N_ = 0;
};

// From which on an approach from further away is no faster: the way on which the speed is reached that is allowed, and
// that on which the spring slows it down.
double far_m(const AxisDesign& axis) {
  const double speed_m_s = axis.max_approach_speed_m_s, k21 = axis.approach_damping_Ns_per_m;
  if (!std::isfinite(speed_m_s)) return std::numeric_limits<double>::infinity();
  const double spare_N = std::min(axis.max_force_N, k21 * speed_m_s) - axis.friction.lower_N;
  const double speeding_m = axis.mass_kg * speed_m_s * speed_m_s / spare_N + 10 * speed_m_s * axis.mass_kg / k21;
  return k21 * speed_m_s / axis.stiffness_N_per_m + speeding_m;
}

// More than the law gives where the axis does not come to a hold.
int kicks_from(const AxisDesign& axis, const PdTables& tables, double distance_m) {
  Trial trial{axis, tables, axis.friction.upper_N, distance_m};
  trial.run([](const auto& law) { return law.mode() != law::Mode::hold && law.mode() != law::Mode::fault; });
  const law::AxisController<float>& law = trial.controller();
  return law.mode() == law::Mode::hold ? static_cast<int>(law.kicks()) : law::KickJudge<float>::most_kicks + 1;
}

}  // namespace

law::AxisParameters<float> parameters_of_pd(const AxisDesign& axis) {
  law::AxisParameters<float> p;
  p.mass_kg = static_cast<float>(axis.mass_kg);
  p.stiffness_N_per_m = static_cast<float>(axis.stiffness_N_per_m);
  p.approach_damping_Ns_per_m = static_cast<float>(axis.approach_damping_Ns_per_m);
  p.kick_damping_Ns_per_m = static_cast<float>(axis.kick_damping_Ns_per_m);
  p.friction = {static_cast<float>(axis.friction.lower_N), static_cast<float>(axis.friction.upper_N)};
  p.max_force_N = static_cast<float>(axis.max_force_N);
  p.max_approach_speed_m_s = static_cast<float>(axis.max_approach_speed_m_s);
  p.position_tolerance_m = static_cast<float>(axis.position_tolerance_m);
  p.encoder_resolution_m = static_cast<float>(axis.encoder_resolution_m);
  p.period_s = static_cast<float>(axis.period_s);
  p.latency_periods = static_cast<std::uint8_t>(axis.latency_ticks);
  return p;
}

int most_tried_kicks() noexcept { return law::KickJudge<float>::most_kicks * 2 / 3; }

PdPromise try_pd(const AxisDesign& axis, const law::K3Table<float>& k3) {
  const PdKicks<float> kicks = design_pd_kicks(parameters_of_pd(axis), axis.current_loop_lag_s);
  const PdTables tables{k3, kicks.table};
  const double stuck_m = axis.friction.upper_N / axis.stiffness_N_per_m, far = far_m(axis);
  const double way_m = axis.longest_way_m > 0 ? std::min(axis.longest_way_m, far) : far;
  constexpr double none = std::numeric_limits<double>::infinity();
  PdPromise promise{.beyond_m = none, .approach_peak_m_s = none, .most_kicks = 0, .aim_lost = kicks.aim_lost};
  if (std::isfinite(way_m)) {
    Trial approach{axis, tables, axis.friction.lower_N, way_m};
    approach.run([](const auto& law) { return law.mode() == law::Mode::approach; });
    const double passed_m = std::max(approach.mass().furthest_m(), 0.0);
    promise.beyond_m =
        std::max(surely * passed_m + axis.position_tolerance_m + 2 * axis.encoder_resolution_m, by_a_kick * stuck_m);
    promise.approach_peak_m_s = surely * approach.mass().fastest_m_s();
  }
  promise.beyond_m = std::max(promise.beyond_m, kicks.beyond * stuck_m);
  for (const double share : {1.0, 0.4, 0.15, 0.05})
    promise.most_kicks = std::max(promise.most_kicks, kicks_from(axis, tables, share * stuck_m));
  return promise;
}

}  // namespace breakaway::design::detail
