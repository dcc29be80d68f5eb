#include "breakaway/machine/run_machine.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "breakaway/machine/certificates.hpp"
#include "breakaway/report/json_writer.hpp"
#include "breakaway/scenario/input_error.hpp"

namespace breakaway::machine {
namespace {

using scenario::MachineScenario;
using State = hybrid::MachineState<Eigen::Dynamic>;

std::vector<int> sliding_signs(const plant::LinearMachine<>& machine, const Eigen::VectorXd& v) {
  constexpr double rounding = 1e-13;
  std::vector<int> signs;
  for (const auto direction : machine.directions.colwise()) {
    const double rate = direction.dot(v), scale = direction.cwiseAbs().dot(v.cwiseAbs());
    signs.push_back(std::abs(rate) <= rounding * scale ? 0 : rate > 0 ? 1 : -1);
  }
  return signs;
}

void append_mode(MachineResult& result, std::vector<int> mode) {
  if (result.modes.empty() || result.modes.back() != mode) result.modes.push_back(std::move(mode));
}

// At an event a direction that begins to slide has no velocity yet: the mode shows half-way to the next one.
void run_event_driven(const MachineScenario& s, MachineResult& result) {
  const hybrid::EventDriven<> integrator{s.machine};
  std::vector<State> corners;
  result.outcome =
      integrator.run(*s.start, s.duration_s, &result.events, [&](const State& state) { corners.push_back(state); });
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const double from_s = corners[i].time_s, to_s = corners[i + 1].time_s;
    if (!(to_s > from_s)) continue;
    append_mode(result, sliding_signs(s.machine, integrator.run(corners[i], (from_s + to_s) / 2).end.v));
  }
  if (result.settled()) append_mode(result, std::vector<int>(static_cast<std::size_t>(s.machine.frictions()), 0));
}

void run_time_stepping(const MachineScenario& s, MachineResult& result) {
  const hybrid::TimeStepping<> integrator{s.machine, {.step_s = s.step_s, .theta = s.theta}};
  result.warning = integrator.warning();
  result.outcome = integrator.run(*s.start, s.duration_s, &result.events,
                                  [&](const State& state) { append_mode(result, sliding_signs(s.machine, state.v)); });
}

const char* name(hybrid::EventKind kind) {
  switch (kind) {
    case hybrid::EventKind::stick:
      return "stick";
    case hybrid::EventKind::slip:
      return "slip";
    case hybrid::EventKind::reversal:
      return "reversal";
  }
  return "";
}

void write_vector(report::JsonWriter& json, std::string_view name, const Eigen::VectorXd& vector) {
  json.array(name, [&] {
    for (const double entry : vector) json.value(entry);
  });
}

}  // namespace

MachineResult run_machine(const MachineScenario& s) {
  if (!s.start) throw scenario::InputError{fmt::format("{}: [start] is missing; give it q, and v unless 0", s.file)};
  MachineResult result;
  result.proved = ProvenFate<Eigen::Dynamic>{s.machine, certify(s.machine)}(*s.start);
  try {
    s.integrator == scenario::Integrator::event_driven ? run_event_driven(s, result) : run_time_stepping(s, result);
  } catch (const std::invalid_argument& error) {
    throw scenario::InputError{fmt::format("{}: {}", s.file, error.what())};
  }
  return result;
}

std::string to_json(const MachineScenario& s, const MachineResult& result) {
  report::JsonWriter json;
  json.object([&] {
    json.member("title", s.title);
    json.member("settled", result.settled());
    json.member("settling_time_s", result.settled() ? result.outcome.settling_time_s : std::nan(""));
    json.member("time_s", result.outcome.end.time_s);
    write_vector(json, "q_end", result.outcome.end.q);
    write_vector(json, "v_end", result.outcome.end.v);
    json.member("certified_attracted", result.proved == hybrid::Verdict::captured);
    json.member("certified_lost", result.proved == hybrid::Verdict::lost);
    json.member("integrator", s.integrator == scenario::Integrator::event_driven ? "event_driven" : "time_stepping");
    json.member("steps", result.outcome.steps);
    json.member("warning", result.warning);
    json.array("modes", [&] {
      for (const auto& mode : result.modes) {
        json.array([&] {
          for (const int sign : mode) json.value(sign);
        });
      }
    });
    json.array("events", [&] {
      for (const hybrid::Event& event : result.events) {
        json.object([&] {
          json.member("time_s", event.time_s);
          json.member("kind", name(event.kind));
          json.member("dof", event.direction);
        });
      }
    });
  });
  return json.text();
}

}  // namespace breakaway::machine
