#include "breakaway/sil/run_ideal_scenario.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "plant_budget.hpp"

namespace breakaway::sil {
namespace {

constexpr double never = std::numeric_limits<double>::quiet_NaN();

// The distance from |value| to the next double.
double resolution(double value) {
  return std::nextafter(std::fabs(value), std::numeric_limits<double>::infinity()) - std::fabs(value);
}

law::K3Table<double> kick_table(const law::AxisParameters<double>& p) {
  return design::build_k3_table<double>({p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N},
                                        p.stick_radius_upper_m())
      .table;
}

// What is proved of the law holds where it is told the truth, and nothing but friction disturbs the axis.
bool proved_for(const config::Axis& axis, const scenario::AxisWorld& world) {
  const config::Truth truth = config::truth_of(axis);
  const auto &told = axis.friction.bounds, &bounds = truth.bounds;
  return axis.mass_kg == truth.mass_kg && told.lower_N <= bounds.lower_N && told.upper_N >= bounds.upper_N &&
         world.plant.force_N == 0 && !world.drift;
}

class IdealRun {
 public:
  IdealRun(const scenario::Scenario& s, std::size_t place, const RecordingOptions& recording,
           motion::WorkBudget& budget)
      : axis_{s.node.axes[place]},
        duration_s_{s.run->duration_s},
        parameters_{config::axis_parameters<double>(s.node, axis_)},
        table_{kick_table(parameters_)},
        controller_{parameters_, table_},
        force_N_{s.worlds[place].plant.force_N},
        proved_{proved_for(axis_, s.worlds[place])},
        slide_{config::truth_of(axis_).mass_kg,
               friction_of(s.worlds[place]),
               {0, s.worlds[place].position_m, s.worlds[place].velocity_m_s},
               s.worlds[place].tolerance.value_or(motion::Slide::usual_tolerance)} {
    result_.name = axis_.name;
    result_.told = config::told_otherwise(axis_);
    slide_.limit_work(&budget);
    if (recording.trace) record();
  }

  AxisResult run() {
    const auto& changes = axis_.controller.targets;
    double target_m = axis_.controller.target_m;
    for (std::size_t i = 0; i <= changes.size(); ++i) {
      const double end_s = i < changes.size() ? std::min(changes[i].time_s, duration_s_) : duration_s_;
      approach(target_m, end_s, i == changes.size());
      if (i < changes.size()) target_m = changes[i].position_m;
    }
    result_.final_error_m = error_m();
    result_.max_force_N = never;  // impulses have no finite force
    result_.ideal = figures_;
    result_.ideal->steps = slide_.counters().steps;
    return std::move(result_);
  }

  double time_s() const { return slide_.state().time_s; }

 private:
  double error_m() const { return slide_.state().position_m - target_m_; }

  model::AppliedForce feedback() const {
    return {.constant_N = force_N_,
            .stiffness_N_per_m = parameters_.stiffness_N_per_m,
            .damping_Ns_per_m = controller_.damping_Ns_per_m(),
            .reference_m = target_m_};
  }

  void approach(double target_m, double end_s, bool last) {
    const double start_s = slide_.state().time_s;
    if (start_s >= end_s) return;
    controller_.shift_target(target_m - target_m_);
    target_m_ = target_m;
    figures_ = {never, never, never, never, never, never, 0};
    result_.settled = false;
    result_.settling_time_s = never;
    answer();
    while (!reached() && slide_.state().time_s < end_s) {
      if (slide_.advance_to(end_s, feedback(), true) == motion::StopReason::came_to_rest) answer();
    }
    if (!result_.settled) return;
    result_.settling_time_s = figures_.t_inf_s - start_s;
    // The rest of the way to the target takes less than the resolution of time.
    if (!last) slide_.advance_to(end_s, feedback());
  }

  // What the law makes of the present state: at rest within the maximal stick set, a kick.
  void answer() {
    const auto output = controller_.update({error_m(), slide_.state().velocity_m_s});
    if (controller_.fault() != law::ControlFault::none && result_.faults.empty())
      result_.faults.push_back({slide_.state().time_s, std::string{law::to_string(controller_.fault())}});
    const bool rests_on_target = error_m() == 0 && slide_.state().velocity_m_s == 0;
    if (!output.kicked && !rests_on_target) return;
    const motion::SlideState before = slide_.state();
    note_rest(before.time_s);
    if (result_.settled) return;
    slide_.apply_impulse(output.impulse_Ns);
    result_.kicks.push_back({.time_s = before.time_s,
                             .position_m = before.position_m,
                             .error_m = before.position_m - target_m_,
                             .velocity_after_m_s = slide_.state().velocity_m_s,
                             .impulse_Ns = output.impulse_Ns});
  }

  // Instants of rest: t1, t2, and the end as soon as what is left cannot be told apart from nothing.
  void note_rest(double time_s) {
    if (std::isnan(figures_.t1_s)) figures_.t1_s = time_s;
    if (std::fabs(error_m()) > parameters_.friction.lower_N / parameters_.stiffness_N_per_m) return;
    const double left_s = longest_time_left_s();
    if (std::isnan(figures_.t2_s)) {
      figures_.t2_s = time_s;
      figures_.y2_m = error_m();
      if (proved_) figures_.bound_s = time_s + left_s;
    }
    if (left_s > resolution(time_s) && std::fabs(error_m()) > 2 * resolution(target_m_)) return;
    result_.settled = true;
    figures_.t_inf_s = time_s + left_s / 2;
    if (proved_) figures_.t_inf_width_s = left_s;
  }

  bool reached() const { return result_.settled; }

  // The right-hand side of (19), from the present place of rest.
  double longest_time_left_s() const {
    const double least_N = parameters_.friction.lower_N;
    return std::sqrt(2 * std::fabs(error_m()) * parameters_.mass_kg / least_N) /
           (1 - std::sqrt(1 - least_N / parameters_.friction.upper_N));
  }

  void record() {
    const double interval_s = 2e-3 * std::sqrt(parameters_.mass_kg / parameters_.stiffness_N_per_m);
    slide_.observe(interval_s, [this](const motion::SlideState& now, double friction_level_N) {
      result_.trace.push_back({.time_s = now.time_s,
                               .position_m = now.position_m,
                               .velocity_m_s = now.velocity_m_s,
                               .force_N = feedback().at_N(now.time_s, now.position_m, now.velocity_m_s),
                               .friction_level_N = friction_level_N,
                               .target_m = target_m_,
                               .mode = controller_.mode()});
    });
  }

  const config::Axis& axis_;
  double duration_s_;
  law::AxisParameters<double> parameters_;
  law::K3Table<double> table_;
  law::AxisController<double> controller_;
  double force_N_;
  bool proved_;
  motion::Slide slide_;
  double target_m_ = 0;
  IdealFigures figures_;
  AxisResult result_;
};

}  // namespace

Result run_ideal_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording) {
  const auto begin = std::chrono::steady_clock::now();
  Result result;
  for (std::size_t place = 0; place < scenario.axes(); ++place) {
    motion::WorkBudget budget = plant_budget(scenario);
    IdealRun axis{scenario, place, recording, budget};
    result.axes.push_back(axis.run());
    result.work += budget.spent();
    result.work_share = std::max(result.work_share, budget.share());
    result.duration_s = std::max(result.duration_s, axis.time_s());
  }
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace breakaway::sil
