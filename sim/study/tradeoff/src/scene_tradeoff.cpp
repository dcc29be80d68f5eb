#include "breakaway/tradeoff/scene_tradeoff.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/sil/axis_accuracy.hpp"
#include "breakaway/sil/method_choice.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "breakaway/tradeoff/cost.hpp"
#include "scene_parts.hpp"

namespace breakaway::tradeoff {
namespace {

using scenario::MachineScenario;
using scenario::Scenario;

struct Difference {
  double end_m, way_m;
};

// --- axes

double position_at_m(const std::vector<sil::Sample>& trace, double time_s) {
  const auto next = std::ranges::lower_bound(trace, time_s, {}, &sil::Sample::time_s);
  if (next == trace.begin()) return trace.front().position_m;
  if (next == trace.end()) return trace.back().position_m;
  const sil::Sample& before = *(next - 1);
  const double share = (time_s - before.time_s) / (next->time_s - before.time_s);
  return before.position_m + share * (next->position_m - before.position_m);
}

// Where one run ended before the other, its axis stays where it was. Between samples positions are interpolated.
Difference difference(const sil::Result& whole, const sil::Result& without) {
  Difference d{0, 0};
  for (std::size_t i = 0; i < whole.axes.size(); ++i) {
    const sil::AxisResult &a = whole.axes[i], &b = without.axes[i];
    d.end_m = std::max(d.end_m, std::abs(a.final_error_m - b.final_error_m));
    for (const sil::Sample& sample : a.trace) {
      d.way_m = std::max(d.way_m, std::abs(sample.position_m - position_at_m(b.trace, sample.time_s)));
    }
  }
  d.way_m = std::max(d.way_m, d.end_m);
  return d;
}

sil::Result recorded(const Scenario& s) { return sil::run_scenario(s, {.trace = true}); }
void run_only(const Scenario& s) { keep(sil::run_scenario(s, {}).axes.front().final_error_m); }

double asked_m(const Scenario& s) { return s.run->accuracy_m.value(); }
const std::string& title_of(const Scenario& s) { return s.node.title; }
const auto& parts_of(const Scenario&) { return axis_parts(); }

// --- machines

Difference difference(const sil::MachineResult& whole, const sil::MachineResult& without) {
  const double end_m = (whole.outcome.end.q - without.outcome.end.q).cwiseAbs().maxCoeff();
  return {end_m, end_m};
}

sil::MachineResult recorded(const MachineScenario& s) { return sil::run_machine(s); }
void run_only(const MachineScenario& s) { keep(sil::run_machine(s).outcome.end.q[0]); }

double asked_m(const MachineScenario& s) { return s.accuracy_m.value(); }
const std::string& title_of(const MachineScenario& s) { return s.title; }
const auto& parts_of(const MachineScenario&) { return machine_parts(); }

void forget_accuracy(Scenario& s) { s.run->accuracy_m.reset(); }
void forget_accuracy(MachineScenario& s) { s.accuracy_m.reset(); }

// --- both

// Whole scene first: what a part saves is told as a share of it.
template <class AnyScenario>
double saved_share(const AnyScenario& whole, const AnyScenario& without) {
  const auto work = [](const char* name, const AnyScenario& s) {
    return Work{name, [s]() -> std::function<void()> { return [s] { run_only(s); }; }};
  };
  const std::vector<Cost> costs = measure_costs({work("whole", whole), work("without", without)}, {});
  return 1 - costs[1].time_ratio;
}

template <class AnyScenario>
std::vector<LeftOutPart> leave_out_parts(AnyScenario whole, const Progress& progress) {
  forget_accuracy(whole);
  const auto complete = recorded(whole);
  std::vector<LeftOutPart> rows;
  for (const auto& part : parts_of(whole)) {
    if (!part.is_there(whole)) continue;
    if (progress) progress("without: " + part.name);
    LeftOutPart row{part.name, not_measured, not_measured, not_measured, {}};
    AnyScenario without = whole;
    part.leave_out(without);
    try {
      const Difference d = difference(complete, recorded(without));
      row.end_m = d.end_m;
      row.way_m = d.way_m;
      row.saved_share = saved_share(whole, without);
    } catch (const InputError& error) {
      row.impossible = error.what();
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

template <class AnyScenario>
SceneTradeoff measure(const AnyScenario& scenario, const Progress& progress) {
  SceneTradeoff scene;
  scene.title = title_of(scenario);
  scene.asked_m = asked_m(scenario);
  if (progress) progress("choosing the method");
  try {
    scene.choice = sil::choose_method(scenario);
  } catch (const sil::AccuracyRefused& refusal) {
    scene.refusal = refusal;
  }
  if (progress) progress("trying all methods");
  scene.trials = sil::try_methods(scenario);
  scene.parts = leave_out_parts(scenario, progress);
  return scene;
}

}  // namespace

SceneTradeoff measure_scene(const Scenario& scenario, const Progress& progress) { return measure(scenario, progress); }

SceneTradeoff measure_scene(const MachineScenario& scenario, const Progress& progress) {
  return measure(scenario, progress);
}

}  // namespace breakaway::tradeoff
