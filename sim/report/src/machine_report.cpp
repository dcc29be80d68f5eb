#include "breakaway/report/machine_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "breakaway/format/html_page.hpp"
#include "breakaway/format/json_writer.hpp"
#include "breakaway/report/accuracy_json.hpp"
#include "motion_picture.hpp"

namespace breakaway::report {
namespace {

using scenario::MachineScenario;
using State = hybrid::MachineState<Eigen::Dynamic>;

std::string numbered(const char* name, Eigen::Index count) {
  std::string columns;
  for (Eigen::Index i = 1; i <= count; ++i) columns += fmt::format(",{}{}", name, i);
  return columns;
}

std::string outcome(const MachineScenario& s, const sil::MachineResult& result) {
  format::HtmlTable table;
  table.quantity(result.settled() ? "At rest from" : "Followed until", result.outcome.settling_time_s, "s");
  for (Eigen::Index i = 0; i < s.machine.coordinates(); ++i) {
    table.row(fmt::format("q<sub>{0}</sub>, v<sub>{0}</sub> at the end", i + 1),
              fmt::format("{:.9g} m, {:.9g} m/s", result.outcome.end.q[i], result.outcome.end.v[i]));
  }
  table.row("Events", fmt::format("{}", result.events.size()));
  table.row("Impulses", fmt::format("{}", s.impulses.size()));
  if (result.proved != hybrid::Verdict::undecided) {
    table.row("Certified", result.proved == hybrid::Verdict::captured ? "to come to rest" : "never to come to rest");
  }
  if (!result.warning.empty()) table.row("Warning", result.warning);
  return table.text();
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

}  // namespace

std::string to_json(const scenario::MachineScenario& s, const sil::MachineResult& result) {
  format::JsonWriter json;
  json.object([&] {
    json.member("title", s.title);
    json.member("settled", result.settled());
    json.member("settling_time_s", result.settled() ? result.outcome.settling_time_s : std::nan(""));
    json.member("time_s", result.outcome.end.time_s);
    json.numbers("q_end", result.outcome.end.q);
    json.numbers("v_end", result.outcome.end.v);
    json.member("certified_attracted", result.proved == hybrid::Verdict::captured);
    json.member("certified_lost", result.proved == hybrid::Verdict::lost);
    json.member("integrator", scenario::to_string(result.accuracy ? result.accuracy->method.integrator : s.integrator));
    json.member("steps", result.outcome.steps);
    json.member("warning", result.warning);
    if (result.accuracy) write_accuracy(json, *result.accuracy);
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

std::string to_csv(const MachineScenario& s, const sil::MachineResult& result) {
  const Eigen::Index n = s.machine.coordinates();
  std::string text = "time_s" + numbered("q", n) + numbered("v", n) + numbered("slides", s.machine.frictions()) + "\n";
  for (const State& state : result.trace) {
    text += fmt::format("{}", state.time_s);
    for (const double q : state.q) text += fmt::format(",{}", q);
    for (const double v : state.v) text += fmt::format(",{}", v);
    for (const int sign : sil::sliding_signs(s.machine, state.v)) text += fmt::format(",{}", sign);
    text += '\n';
  }
  return text;
}

std::string to_html(const MachineScenario& s, const sil::MachineResult& result) {
  const std::string sections =
      format::html_section("Outcome", outcome(s, result), "") +
      format::html_section("Motion", draw_motion(result.trace),
                           "Coordinates and their velocities. While a friction sticks, its sliding velocity is zero.");
  return format::html_page(s.title.empty() ? "Motion of a machine" : s.title, result.settled(),
                           result.settled() ? "came to rest" : "not proved to be at rest", sections);
}

}  // namespace breakaway::report
