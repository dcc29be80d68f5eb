#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/matrix_values.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/config/toml_section.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "read_coupled.hpp"
#include "read_friction.hpp"

namespace breakaway::scenario {

using namespace config;
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double longest_s = 1e9;
// As for the friction of an axis. Beyond, squares of a friction force along its direction are no numbers any more, and
// neither decisions about sticking nor certificates would end.
constexpr Range friction{0, 1e12}, direction{-1e12, 1e12};

// The error with the place of its key in the file; an entry of an array stands where the array does.
void require_valid(const Section& section, const stability::LinearMachine<>& machine) {
  try {
    stability::require_valid(machine);
  } catch (const InputError& error) {
    const std::string key = error.key().substr(0, error.key().find('['));
    section.fail(key, std::string{error.what()}.substr(key.size() + (key.size() == error.key().size() ? 1 : 0)));
  }
}

// One for each direction. Only where a law is named do they stay; else friction is constant, at its upper bound.
void read_frictions(const Section& section, MachineScenario& s) {
  bool varies = false;
  section.read_alone(optional("friction", tables([&](const Section& entry) {
                                varies |= entry.has("law");
                                s.laws.push_back(read_friction_law(entry));
                              })));
  const auto m = static_cast<Index>(s.laws.size());
  if (m != s.machine.directions.cols()) {
    section.fail("friction", fmt::format("has {} entries, must have {}: one for each column of directions", m,
                                         s.machine.directions.cols()));
  }
  s.machine.friction_N.resize(m);
  for (Index i = 0; i < m; ++i) {
    const auto& bounds = s.laws[static_cast<std::size_t>(i)].bounds();
    s.machine.friction_N[i] = varies ? bounds.lower_N : bounds.upper_N;
  }
  if (!varies) s.laws.clear();
}

void read_machine(const Section& section, MachineScenario& s) {
  stability::LinearMachine<>& machine = s.machine;
  const bool each = section.has("friction");
  if (each && section.has("friction_N")) section.fail("friction", "stands beside friction_N; give one of them");
  const Value constants = vector(machine.friction_N, "N", friction);
  const Value later = tables([](const Section&) {});
  section.read({
      required("mass", matrix(machine.mass, "kg")),
      required("damping", matrix(machine.damping, "N s/m")),
      required("stiffness", matrix(machine.stiffness, "N/m")),
      required("directions", matrix(machine.directions, "", direction)),
      each ? required("friction", later) : required("friction_N", constants),
      optional("force_N", vector(machine.force_N, "N")),
  });
  if (each) read_frictions(section, s);
  require_valid(section, machine);
}

void require_size(const Section& section, std::string_view key, const MatrixXd& matrix, Index rows, Index columns) {
  if (matrix.rows() == rows && matrix.cols() == columns) return;
  section.fail(key, fmt::format("is {} x {}, must be {} x {} here", matrix.rows(), matrix.cols(), rows, columns));
}

stability::LinearMachine<> close_loop(const Section& section, const stability::LinearMachine<>& machine) {
  const Index n = machine.coordinates();
  MatrixXd actuators = MatrixXd::Identity(n, n);
  MatrixXd position_gain, velocity_gain;
  section.read({
      optional("actuators", matrix(actuators, "")),
      optional("position_gain", matrix(position_gain, "N/m")),
      optional("velocity_gain", matrix(velocity_gain, "N s/m")),
  });
  require_size(section, "actuators", actuators, n, actuators.cols());
  if (position_gain.size() == 0) position_gain.setZero(actuators.cols(), n);
  if (velocity_gain.size() == 0) velocity_gain.setZero(actuators.cols(), n);
  require_size(section, "position_gain", position_gain, actuators.cols(), n);
  require_size(section, "velocity_gain", velocity_gain, actuators.cols(), n);
  return stability::with_feedback(machine, actuators, position_gain, velocity_gain);
}

void require_integrator(const Section& section, std::string_view key, bool fits, const char* integrator) {
  if (fits || !section.has(key)) return;
  section.fail(key, fmt::format("needs integrator = \"{}\"; the others do not know it", integrator));
}

DampingSweep read_sweep(const Section& section, Index coordinates) {
  DampingSweep sweep;
  sweep.per_d1 = MatrixXd::Identity(coordinates, coordinates);
  section.read({
      required("damping", matrix(sweep.damping, "N s/m")),
      optional("per_d1", matrix(sweep.per_d1, "")),
      required("d1", numbers(sweep.d1, "N s/m")),
  });
  require_size(section, "damping", sweep.damping, coordinates, coordinates);
  require_size(section, "per_d1", sweep.per_d1, coordinates, coordinates);
  return sweep;
}

void read_run(const Section& section, MachineScenario& s) {
  const std::vector<Key> known{
      optional("duration_s", number(s.duration_s, "s", {0, longest_s, true})),
      optional("integrator", choice(s.integrator, {{"event_driven", Integrator::event_driven},
                                                   {"time_stepping", Integrator::time_stepping},
                                                   {"adaptive", Integrator::adaptive}})),
      optional("step_s", number(s.step_s, "s", {1e-9, 1e9})),
      optional("theta", number(s.theta, "", {0, 1})),
      optional("tolerance", number(s.tolerance, "", {1e-14, 1e-2})),
      optional("accuracy_m", number(s.accuracy_m, "m", positive)),
  };
  section.read(known +
               elsewhere({"settle_tolerance_m", "settle_time_s", "stop_when_settled"},
                         "it is for axes with a [controller], and a [machine] alone rests or does not; leave it "
                         "out"));
  s.integrator_is_named = section.has("integrator");
  for (const char* chosen : {"step_s", "tolerance"}) {
    if (s.accuracy_m && section.has(chosen))
      section.fail(chosen, "stands beside accuracy_m, which chooses it; leave one of them out");
  }
  const bool stepping = s.integrator == Integrator::time_stepping, adaptive = s.integrator == Integrator::adaptive;
  if (!s.laws.empty() && !adaptive) {
    section.fail("integrator", fmt::format("= \"{}\" knows constant friction only, and a friction of the machine has a "
                                           "law; take \"adaptive\"",
                                           stepping ? "time_stepping" : "event_driven"));
  }
  require_integrator(section, "step_s", stepping, "time_stepping");
  require_integrator(section, "theta", stepping, "time_stepping");
  require_integrator(section, "tolerance", adaptive, "adaptive");
  if (stepping && s.duration_s / s.step_s > 1e10) {
    section.fail("step_s", "makes more than 1e10 steps in duration_s; raise it");
  }
}

void read_impulse(const Section& section, MachineScenario& s) {
  MachineImpulse impulse;
  section.read({required("time_s", number(impulse.time_s, "s", {0, longest_s})),
                required("impulse_Ns", vector(impulse.impulse_Ns, "N s"))});
  require_size(section, "impulse_Ns", impulse.impulse_Ns, s.machine.coordinates(), 1);
  if (impulse.time_s > s.duration_s)
    section.fail("time_s", fmt::format("is {}, after the end at duration_s = {}; give an earlier one or raise that",
                                       impulse.time_s, s.duration_s));
  if (!s.impulses.empty() && impulse.time_s < s.impulses.back().time_s) {
    section.fail("time_s", fmt::format("is {}, before that of the entry above; put them in order", impulse.time_s));
  }
  s.impulses.push_back(std::move(impulse));
}

MachineScenario read_machine_document(const toml::table& document, const std::string& name, KnownTables* known_tables) {
  const Section root{document, name, "", known_tables};
  MachineScenario s;
  s.file = name;
  if (has_axes(document) && root.has("machine"))
    root.fail("machine", "has axes with drives beside it, which `simulate` runs; leave them out to look at it alone");
  if (has_axes(document))
    throw InputError{
        "describes an axis, and a [machine] is asked for: take `simulate`, `design` or `study`, or give a file with a "
        "[machine]"}
        .in_file(name);
  if (!root.has("machine"))
    root.fail("machine", "is missing; give it mass, damping, stiffness, directions and friction_N");
  std::optional<Section> machine, feedback, start, run, sweep;
  const std::vector<Key> known{
      optional("title", text(s.title)),
      required("machine", table([&](const Section& part) { machine = part; })),
      optional("sweep", table([&](const Section& part) { sweep = part; })),
      optional("feedback", table([&](const Section& part) { feedback = part; })),
      optional("start", table([&](const Section& part) { start = part; })),
      optional("run", table([&](const Section& part) { run = part; })),
      optional("impulse", tables([](const Section&) {})),
  };
  root.read(known + elsewhere({"friction", "limits", "bus", "told", "uncertainty"},
                              "it is for an axis, and this [machine] stands alone; leave it out, or describe the axis "
                              "with [plant] and [controller]"));
  read_machine(*machine, s);
  if (feedback) s.machine = close_loop(*feedback, s.machine);
  require_valid(*machine, s.machine);
  if (start) s.start = read_start(*start, s.machine.coordinates());
  if (!s.laws.empty()) s.integrator = Integrator::adaptive;
  if (sweep) s.sweep = read_sweep(*sweep, s.machine.coordinates());
  if (run) read_run(*run, s);
  root.read_alone(optional("impulse", tables([&](const Section& part) { read_impulse(part, s); })));
  return s;
}

}  // namespace

stability::LinearMachine<> read_coupled_machine(const Section& section) {
  MachineScenario s;
  read_machine(section, s);
  if (!s.laws.empty())
    section.fail("friction", "has a law; behind drives the friction of a machine is constant: leave the law out");
  return std::move(s.machine);
}

stability::MachineState<Eigen::Dynamic> read_start(const Section& section, Index coordinates, Range range) {
  stability::MachineState<Eigen::Dynamic> start;
  section.read({required("q", vector(start.q, "m", range)), optional("v", vector(start.v, "m/s", range))});
  if (start.v.size() == 0) start.v.setZero(coordinates);
  require_size(section, "q", start.q, coordinates, 1);
  require_size(section, "v", start.v, coordinates, 1);
  return start;
}

const char* to_string(Integrator integrator) {
  switch (integrator) {
    case Integrator::event_driven:
      return "event_driven";
    case Integrator::time_stepping:
      return "time_stepping";
    case Integrator::adaptive:
      return "adaptive";
  }
  return "";
}

MachineScenario parse_machine_scenario(std::string_view text, const std::string& name, KnownTables* known) {
  return with_document(text, name,
                       [&](const toml::table& document) { return read_machine_document(document, name, known); });
}

MachineScenario read_machine_scenario(const std::filesystem::path& file) {
  return parse_machine_scenario(file_contents(file), shown_name(file));
}

std::variant<Scenario, MachineScenario> parse_any_scenario(std::string_view text, const std::string& name,
                                                           KnownTables* known) {
  const bool machine = with_document(
      text, name, [](const toml::table& document) { return document.contains("machine") && !has_axes(document); });
  if (machine) return parse_machine_scenario(text, name, known);
  return parse_scenario(text, name, known);
}

std::variant<Scenario, MachineScenario> read_any_scenario(const std::filesystem::path& file) {
  return parse_any_scenario(file_contents(file), shown_name(file));
}

}  // namespace breakaway::scenario
