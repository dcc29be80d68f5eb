#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/design/k3.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/report/design_json.hpp"
#include "breakaway/report/formats.hpp"
#include "breakaway/report/identification_report.hpp"
#include "breakaway/report/machine_report.hpp"
#include "breakaway/report/study_json.hpp"
#include "breakaway/report/tune_json.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "breakaway/study/friction_study.hpp"
#include "breakaway/study/identification.hpp"
#include "breakaway/study/tune.hpp"
#include "core.hpp"

namespace breakaway::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using scenario::Scenario;

// One result for each position, in the shape of the positions.
template <class Function>
Numbers for_each(const Numbers& positions, Function function) {
  Numbers results{std::vector<py::ssize_t>(positions.shape(), positions.shape() + positions.ndim())};
  double* const to = results.mutable_data();
  const double* const from = positions.data();
  for (py::ssize_t i = 0; i < positions.size(); ++i) to[i] = function(from[i]);
  return results;
}

double finite(double value, double position_m) {
  if (std::isfinite(value)) return value;
  throw InputError{"position_m",
                   "of " + to_text(position_m) +
                       " m is not finite, or k3 there is beyond the range of floating point; check the units"};
}

std::pair<Numbers, Numbers> k3(const Numbers& positions, double mass_kg, double stiffness, double damping,
                               double friction_lower_N) {
  const auto law = design::K3<double>::make({mass_kg, stiffness, damping, friction_lower_N});
  return {for_each(positions, [&](double y) { return finite(law.impulse_Ns(y) + 0.0, y); }),
          for_each(positions, [&](double y) { return finite(law.time_to_go_s(y), y); })};
}

InputError several_axes(const std::string& file) {
  return InputError{"has several axes: name one of them by axis=\"...\""}.in_file(file);
}

Scenario only(Scenario s, const std::string& axis) {
  if (s.machine)
    throw InputError{"has axes that stand on one [machine]: this is of an axis that moves alone"}.in_file(s.node.file);
  if (!axis.empty()) return only_axis(s, axis);
  if (s.axes() > 1) throw several_axes(s.node.file);
  return s;
}

py::dict columns(const std::shared_ptr<sil::Result>& result, const sil::AxisResult& axis) {
  using sil::Sample;
  const auto& trace = axis.trace;
  py::dict arrays;
  arrays["time_s"] = column<double>(result, trace, &Sample::time_s);
  arrays["position_m"] = column<double>(result, trace, &Sample::position_m);
  arrays["velocity_m_s"] = column<double>(result, trace, &Sample::velocity_m_s);
  arrays["force_N"] = column<double>(result, trace, &Sample::force_N);
  arrays["friction_level_N"] = column<double>(result, trace, &Sample::friction_level_N);
  arrays["target_m"] = column<double>(result, trace, &Sample::target_m);
  arrays["bus_load"] = column<double>(result, trace, &Sample::bus_load);
  std::vector<std::string> modes;
  for (const Sample& sample : trace) modes.emplace_back(to_string(sample.mode));
  arrays["mode"] = modes;
  if (!trace.empty() && trace.front().load_position_m) {
    Numbers load{static_cast<py::ssize_t>(trace.size())};
    for (std::size_t i = 0; i < trace.size(); ++i)
      load.mutable_at(static_cast<py::ssize_t>(i)) = trace[i].load_position_m.value_or(std::nan(""));
    arrays["load_position_m"] = load;
  }
  return arrays;
}

// (samples, coordinates)
Numbers table(const std::vector<hybrid::MachineState<Eigen::Dynamic>>& states,
              Eigen::VectorXd hybrid::MachineState<Eigen::Dynamic>::*field) {
  const Eigen::Index width = states.empty() ? 0 : (states.front().*field).size();
  Numbers rows{std::vector<py::ssize_t>{static_cast<py::ssize_t>(states.size()), width}};
  double* to = rows.mutable_data();
  for (const auto& state : states) to = std::copy_n((state.*field).data(), width, to);
  return rows;
}

py::dict columns(const sil::MachineResult& result) {
  using State = hybrid::MachineState<Eigen::Dynamic>;
  py::dict arrays;
  Numbers times{static_cast<py::ssize_t>(result.trace.size())};
  std::ranges::transform(result.trace, times.mutable_data(), &State::time_s);
  arrays["time_s"] = times;
  arrays["q"] = table(result.trace, &State::q);
  arrays["v"] = table(result.trace, &State::v);
  return arrays;
}

sil::RecordingOptions recording(bool trace) { return {.trace = trace, .frames = false, .progress = Interruptible{}}; }

std::pair<std::string, py::dict> run(Scenario s, bool trace, std::optional<double> accuracy_m) {
  if (accuracy_m && s.run) s.run->accuracy_m = accuracy_m;
  std::shared_ptr<sil::Result> result;
  std::string json;
  {
    const py::gil_scoped_release unlocked;
    result = std::make_shared<sil::Result>(sil::run_scenario(s, recording(trace)));
    json = report::to_json(s, *result);
  }
  py::dict arrays;
  if (trace)
    for (const sil::AxisResult& axis : result->axes) arrays[py::str(axis.name)] = columns(result, axis);
  return {json, arrays};
}

std::pair<std::string, py::dict> run(scenario::MachineScenario s, bool trace, std::optional<double> accuracy_m) {
  if (accuracy_m) s.accuracy_m = accuracy_m;
  sil::MachineResult result;
  std::string json;
  {
    const py::gil_scoped_release unlocked;
    result = sil::run_scenario(s, recording(trace));
    json = report::to_json(s, result);
  }
  return {json, trace ? columns(result) : py::dict{}};
}

std::pair<std::string, py::dict> simulate(const std::string& text, const std::string& name, bool trace,
                                          std::optional<double> accuracy_m) {
  if (accuracy_m) require_positive("accuracy_m", *accuracy_m);
  auto any = scenario::parse_any_scenario(text, name);
  return std::visit([&](auto& s) { return run(std::move(s), trace, accuracy_m); }, any);
}

// As the command: what simulate refuses is not certified, and what is certified can be flashed.
std::string design_of(const std::string& text, const std::string& name) {
  const py::gil_scoped_release unlocked;
  const config::Node node = scenario::parse_scenario(text, name).node;
  if (node.coupling) {
    const stability::MachineCertificate certificate = config::examine_machine(node);
    if (certificate.certified) config::certified_machine(node, certificate);
    return report::to_json(node, certificate);
  }
  const auto reports = config::examine(node);
  config::require_flashable(node, reports);
  return report::to_json(node, reports);
}

const config::Axis& braked_axis(const config::Node& node, const std::string& axis) {
  if (node.coupling)
    throw InputError{
        "has a [coupling], whose axes are kicked by one coordinator and not from a table: design() says what their "
        "kicks are"}
        .in_file(node.file);
  if (axis.empty() && node.axes.size() > 1) throw several_axes(node.file);
  const auto found = axis.empty() ? node.axes.begin() : std::ranges::find(node.axes, axis, &config::Axis::name);
  if (found == node.axes.end()) throw InputError{"has no axis \"" + axis + "\""}.in_file(node.file);
  const auto& law = found->controller.impulsive;
  if (!law || law->coast != law::Coast::brake || !node.loop)
    throw InputError{
        "has no table of kicks: it needs a [loop] and coast = \"brake\"; the curve of coast = \"pd\" is k3()"}
        .in_file(node.file);
  return *found;
}

py::dict kick_table(const std::string& text, const std::string& name, const Numbers& distances,
                    const std::string& axis) {
  const config::Node node = config::parse_node(text, name);
  const design::BrakedClass axes = config::braked_class(node, braked_axis(node, axis));
  const auto made = design::design_braked_kicks<double>(axes);
  if (!made.possible()) throw InputError{"has no kick that is sure to move the axis: design() says why"}.in_file(name);
  const auto pulse = [&](double y) {
    if (!(y >= 0)) throw InputError{"distance_m", "must be 0 or more"};
    return made.kicks.table.pulse(y);
  };
  const auto whole_steps_N = [&](double force_N) {
    return std::floor(force_N / axes.force_step_N) * axes.force_step_N;
  };
  py::dict columns;
  columns["force_N"] = for_each(distances, [&](double y) { return whole_steps_N(pulse(y).force_N); });
  columns["periods"] = for_each(distances, [&](double y) { return static_cast<double>(pulse(y).periods); });
  columns["cut_periods"] = for_each(distances, [&](double y) { return static_cast<double>(pulse(y).cut_periods); });
  const auto travel = [&](double y, auto of) {
    const auto p = pulse(y);
    return of(axes, whole_steps_N(p.force_N), p.periods, p.cut_periods);
  };
  columns["most_m"] = for_each(distances, [&](double y) { return travel(y, design::most_travel_m); });
  columns["least_m"] = for_each(distances, [&](double y) { return travel(y, design::least_travel_m); });
  columns["least_distance_m"] = made.kicks.table.least_m();
  columns["reach_m"] = made.kicks.table.reach_m();
  return columns;
}

int checked_laws(int laws, int most) {
  if (laws >= 0 && laws <= most) return laws;
  throw InputError{"laws", "must be from 0 to " + std::to_string(most)};
}

std::string study_of(const std::string& text, const std::string& name,
                     const std::vector<std::pair<double, double>>& starts, int laws, std::uint64_t seed, int threads,
                     const std::string& axis) {
  const py::gil_scoped_release unlocked;
  const Scenario s = study::studied_axis(only(scenario::parse_scenario(text, name), axis));
  study::StudyOptions options{.starts = {},
                              .random_laws = checked_laws(laws, 1'000'000),
                              .seed = seed,
                              .threads = static_cast<unsigned>(threads_or_all(threads)),
                              .progress = Interruptible{}};
  for (const auto& [position_m, velocity_m_s] : starts) options.starts.push_back({position_m, velocity_m_s});
  if (options.starts.empty()) options.starts = study::default_starts(s);
  for (const study::Start& start : options.starts) study::require_within_limits(s, start);
  return report::to_json({{name, s.node, study::run_study(s, options)}}, options);
}

std::pair<std::string, std::string> tune_of(const std::string& text, const std::string& name,
                                            const std::string& objective, int laws, std::uint64_t seed, int threads,
                                            const std::string& axis) {
  const py::gil_scoped_release unlocked;
  const Scenario all = scenario::parse_scenario(text, name);
  if (axis.empty() && all.axes() > 1 && !all.machine && !all.node.coupling) throw several_axes(name);
  const study::Tuning tuning = study::tune(text, name,
                                           {.objective = study::objective_of(objective),
                                            .axis = axis,
                                            .random_laws = checked_laws(laws, 100'000),
                                            .seed = seed,
                                            .threads = static_cast<unsigned>(threads_or_all(threads)),
                                            .progress = Interruptible{}});
  return {report::to_json(tuning), tuning.text};
}

std::pair<std::string, std::string> identify_of(const std::string& text, const std::string& name,
                                                const std::string& record, const std::string& record_name,
                                                std::optional<double> lowest_m, std::optional<double> highest_m,
                                                double duration_s, const std::string& axis) {
  const py::gil_scoped_release unlocked;
  const Scenario s = only(scenario::parse_scenario(text, name), axis);
  if (!record_name.empty() && (lowest_m || highest_m))
    throw InputError{lowest_m ? "lowest_m" : "highest_m",
                     "says how to make an experiment, and record is that of one; leave one of the two out"};
  config::ExperimentRequest request{.duration_s = duration_s};
  if (lowest_m) request.lowest_m = *lowest_m;
  if (highest_m) request.highest_m = *highest_m;
  study::IdentifiedRun found = record_name.empty()
                                   ? study::run_identification(s, request,
                                                               [asked = Interruptible{}](double share) mutable {
                                                                 asked(share);
                                                                 return true;
                                                               })
                                   : study::recorded_identification(s, record, record_name);
  study::evaluate(found);
  return {report::identification_json(found), study::with_found(text, s, found.found)};
}

}  // namespace

void add_axis(py::module_& module) {
  using namespace py::literals;
  module.def("k3", &k3, "position_m"_a, "mass_kg"_a, "k1_N_per_m"_a, "k22_Ns_per_m"_a, "friction_lower_N"_a);
  module.def("simulate", &simulate, "text"_a, "name"_a, "trace"_a, "accuracy_m"_a);
  module.def("design", &design_of, "text"_a, "name"_a);
  module.def("kick_table", &kick_table, "text"_a, "name"_a, "distance_m"_a, "axis"_a);
  module.def("study", &study_of, "text"_a, "name"_a, "starts"_a, "laws"_a, "seed"_a, "threads"_a, "axis"_a);
  module.def("tune", &tune_of, "text"_a, "name"_a, "objective"_a, "laws"_a, "seed"_a, "threads"_a, "axis"_a);
  module.def("identify", &identify_of, "text"_a, "name"_a, "record"_a, "record_name"_a, "lowest_m"_a, "highest_m"_a,
             "duration_s"_a, "axis"_a);
}

}  // namespace breakaway::python
