// Times of the cases that step_count counts. Compare them within one run only: each is reported for one step, call or
// tick (the counter `each`), so that their ratios are what they are about.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "breakaway/design/k3.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"
#include "recording.hpp"
#include "replay.hpp"

namespace breakaway::bench {
namespace {

void report_each(benchmark::State& state, std::size_t per_iteration) {
  state.counters["each"] = benchmark::Counter(
      static_cast<double>(per_iteration), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class Real, class Controller>
void time_controller(const std::string& name, const scenario::Scenario& s, const Controller& controller) {
  const Recording<Real> r = record<Real>(s, controller);
  benchmark::RegisterBenchmark((name + "/all steps").c_str(), [=](benchmark::State& state) {
    for (auto _ : state) {
      replay(s, r, controller,
             [&](Controller& c, std::size_t i) { benchmark::DoNotOptimize(c.update(r.measurements[i])); });
    }
    report_each(state, r.measurements.size());
  });
}

// Steps of one kind, each on a copy of the controller as it was before the step; without `steps`, the copies alone.
template <class Real>
void time_kind(const scenario::Scenario& s, const Recording<Real>& r, const law::AxisController<Real>& controller,
               const std::string& kind, bool steps) {
  std::vector<law::AxisController<Real>> before;
  std::vector<law::Measurement<Real>> samples;
  replay(s, r, controller, [&](law::AxisController<Real>& c, std::size_t i) {
    const law::AxisController<Real> copy = c;
    if (update_and_label(c, r.measurements[i]) != kind || before.size() == 40) return;
    before.push_back(copy);
    samples.push_back(r.measurements[i]);
  });
  const std::string name = label_prefix(controller) + (steps ? kind : "copy");
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    for (auto _ : state) {
      for (std::size_t i = 0; i < before.size(); ++i) {
        law::AxisController<Real> c = before[i];
        if (steps) benchmark::DoNotOptimize(c.update(samples[i]));
        benchmark::DoNotOptimize(c);
      }
    }
    report_each(state, before.size());
  });
}

void time_law(const scenario::Scenario& s) {
  static const auto table = build_table<float>(s).table;
  static const auto table_double = build_table<double>(s).table;
  static const auto pulses = build_pulses<float>(s);
  static const auto pulses_double = build_pulses<double>(s);
  const law::AxisController<float> controller{parameters<float>(s), table, pulses};
  time_controller<float>("PidController float", s, pid_controller<float>(s));
  time_controller<double>("PidController double", s, pid_controller<double>(s));
  time_controller<float>("AxisController float", s, controller);
  time_controller<double>("AxisController double", s,
                          law::AxisController<double>{parameters<double>(s), table_double, pulses_double});
  const Recording<float> r = record<float>(s, controller);
  time_kind(s, r, controller, "hold", false);
  for (const char* kind : all_kinds) time_kind(s, r, controller, kind, true);
}

template <class Real, class Law>
void time_evaluator(const std::string& name, const Law& law, double range_m) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    const std::vector<Real> errors_m = position_errors<Real>(range_m);
    for (auto _ : state) {
      for (const Real y : errors_m) benchmark::DoNotOptimize(law.impulse_Ns(y));
    }
    report_each(state, errors_m.size());
  });
}

void time_k3(const scenario::Scenario& s) {
  const double range_m = parameters<double>(s).stick_radius_upper_m();
  time_evaluator<float>("K3Table float", build_table<float>(s).table, range_m);
  time_evaluator<double>("K3Table double", build_table<double>(s).table, range_m);
  time_evaluator<double>("K3 double", design::K3<double>::make(kick_plant(s)), range_m);
}

struct LoopCase {
  explicit LoopCase(std::size_t axes)
      : s{axis_scenario(axes)},
        table{build_table<float>(s).table},
        pulses{build_pulses<float>(s)},
        controller{parameters<float>(s), table, pulses},
        recording{record<float>(s, controller, loop_steps * s.node.period_s())},
        loop{loop_that_runs(port, s, controller, recording)} {}

  scenario::Scenario s;
  law::K3Table<float> table;
  law::KickTable<float> pulses;
  law::AxisController<float> controller;
  Recording<float> recording;
  TapePort port;
  Loop<float, law::AxisController<float>> loop;
};

void time_loop(std::size_t axes) {
  const auto c = std::make_shared<LoopCase>(axes);
  benchmark::RegisterBenchmark(("ControlLoop " + std::to_string(axes)).c_str(), [c](benchmark::State& state) {
    const Recording<float>& r = c->recording;
    for (auto _ : state) {
      auto loop = c->loop;
      for (std::size_t k = r.first_running + 1; k < r.steps.size(); ++k) run_step(loop, c->port, r, k);
      benchmark::DoNotOptimize(loop);
    }
    report_each(state, r.steps.size() - r.first_running - 1);
  });
}

void time_plant(const std::string& name, const scenario::Scenario& s, const Recording<float>& r) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    for (auto _ : state) {
      Axis axis{s};
      for (const RecordedStep& step : r.steps) push(axis, step);
      benchmark::DoNotOptimize(axis);
    }
    report_each(state, r.steps.size());
  });
}

void time_simulation(scenario::Scenario s) {
  const auto table = build_table<float>(s).table;
  const auto pulses = build_pulses<float>(s);
  const law::AxisController<float> controller{parameters<float>(s), table, pulses};
  const auto r = record<float>(s, controller, tour[1].time_s);
  time_plant("plant, friction of can_axis", s, r);
  benchmark::RegisterBenchmark("whole scenario, with its set-up", [=](benchmark::State& state) {
    std::uint64_t ticks = 0;
    for (auto _ : state) ticks = sil::run_loop_scenario(s, {}).loop->ticks;
    report_each(state, ticks);
  });
  s.worlds[0].friction = {s.worlds[0].friction.bounds(), model::shape::constant(0.5)};
  time_plant("plant, constant friction", s, r);
}

}  // namespace
}  // namespace breakaway::bench

int main(int argc, char** argv) {
  using namespace breakaway::bench;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const auto s = axis_scenario();
  time_law(s);
  time_k3(s);
  for (const std::size_t axes : {1U, 2U, 4U, 8U}) time_loop(axes);
  time_simulation(s);
  benchmark::RunSpecifiedBenchmarks();
}
