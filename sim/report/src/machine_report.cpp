#include "breakaway/report/machine_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/html_page.hpp"
#include "breakaway/format/json_writer.hpp"
#include "breakaway/format/plot_style.hpp"
#include "breakaway/report/accuracy_json.hpp"

namespace breakaway::report {
namespace {

using scenario::MachineScenario;
using State = hybrid::MachineState<Eigen::Dynamic>;

constexpr int width_px = 900, height_px = 700;
constexpr const char* colours[] = {"#1c5d99", "#c8553d", "#2a7f62", "#8f6bb3", "#e08e45", "#777777"};

std::string numbered(const char* name, Eigen::Index count) {
  std::string columns;
  for (Eigen::Index i = 1; i <= count; ++i) columns += fmt::format(",{}{}", name, i);
  return columns;
}

// A line for each coordinate, from the columns of $motion behind `first`.
std::string lines(const char* symbol, Eigen::Index first, Eigen::Index count) {
  std::string plot = "plot ";
  for (Eigen::Index i = 0; i < count; ++i) {
    plot +=
        fmt::format("{}$motion using 1:{} with lines linewidth 1.6 linecolor '{}' title '{}_{{{}}}'", i > 0 ? ", " : "",
                    first + i + 1, colours[static_cast<std::size_t>(i) % std::size(colours)], symbol, i + 1);
  }
  return plot + "\n";
}

std::string motion(const MachineScenario& s, const sil::MachineResult& result) {
  std::string commands = format::plot_style + "$motion << END\n";
  for (const State& state : result.trace) {
    commands += fmt::format("{:.9g}", state.time_s);
    for (const double q : state.q) commands += fmt::format(" {:.9g}", q);
    for (const double v : state.v) commands += fmt::format(" {:.9g}", v);
    commands += '\n';
  }
  const Eigen::Index n = s.machine.coordinates();
  commands += fmt::format("END\nset multiplot layout 2,1\nset xrange [0:{}]\nset ylabel 'coordinates [m]'\n{}",
                          result.trace.back().time_s, lines("q", 1, n));
  commands += fmt::format("set xlabel 'time [s]'\nset ylabel 'velocities [m/s]'\n{}", lines("v", 1 + n, n));
  return format::draw_svg("motion", width_px, height_px, commands);
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

void write_vector(format::JsonWriter& json, std::string_view name, const Eigen::VectorXd& vector) {
  json.array(name, [&] {
    for (const double entry : vector) json.value(entry);
  });
}

}  // namespace

std::string to_json(const scenario::MachineScenario& s, const sil::MachineResult& result) {
  format::JsonWriter json;
  json.object([&] {
    json.member("title", s.title);
    json.member("settled", result.settled());
    json.member("settling_time_s", result.settled() ? result.outcome.settling_time_s : std::nan(""));
    json.member("time_s", result.outcome.end.time_s);
    write_vector(json, "q_end", result.outcome.end.q);
    write_vector(json, "v_end", result.outcome.end.v);
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
    text += fmt::format("{:.17g}", state.time_s);
    for (const double q : state.q) text += fmt::format(",{:.17g}", q);
    for (const double v : state.v) text += fmt::format(",{:.17g}", v);
    for (const int sign : sil::sliding_signs(s.machine, state.v)) text += fmt::format(",{}", sign);
    text += '\n';
  }
  return text;
}

std::string to_html(const MachineScenario& s, const sil::MachineResult& result) {
  const std::string sections =
      format::html_section("Outcome", outcome(s, result), "") +
      format::html_section("Motion", motion(s, result),
                           "Coordinates and their velocities. While a friction sticks, its sliding velocity is zero.");
  return format::html_page(s.title.empty() ? "Motion of a machine" : s.title, result.settled(),
                           result.settled() ? "came to rest" : "not proved to be at rest", sections);
}

}  // namespace breakaway::report
