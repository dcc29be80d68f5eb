#include <fmt/format.h>

#include <algorithm>

#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "can_axis.hpp"
#include "parts.hpp"

namespace breakaway::tradeoff {

scenario::Scenario can_axis() { return scenario::parse_scenario(can_axis_toml, "can_axis.toml"); }

Frontiers measure(const Options& options) {
  const auto say = [&](const char* what) {
    if (options.counting.progress) options.counting.progress(what);
  };
  Frontiers f;
  f.quick = options.quick;
  f.counted = !options.counting.program.empty();
  say("integrators");
  f.integrators = measure_integrators(options);
  f.balls = measure_balls(options.quick);
  say("evaluators of k3");
  f.evaluators = measure_evaluators(options);
  say("control periods");
  f.periods = measure_periods(options.quick);
  say("parts of a scenario");
  f.scenario_parts = measure_scenario_parts(options);
  say("accuracies asked for");
  f.asked = measure_asked();
  f.left_out = measure_parts_asked();
  return f;
}

std::vector<Work> all_works() {
  std::vector<Work> all;
  for (const auto& works : {integrator_works(), evaluator_works(), scenario_part_works()})
    all.insert(all.end(), works.begin(), works.end());
  return all;
}

void do_work(const std::string& name, std::uint64_t repeats) {
  const auto all = all_works();
  const auto found = std::ranges::find(all, name, &Work::name);
  if (found == all.end()) throw InputError{fmt::format("--work: there is no work {}", name)};
  const auto ready = found->prepare();
  for (std::uint64_t i = 0; i < repeats; ++i) ready();
}

}  // namespace breakaway::tradeoff
