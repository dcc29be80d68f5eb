// What is told of a scene: JSON, a table, a picture.
#include <fmt/format.h>

#include <cmath>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/json_writer.hpp"
#include "breakaway/format/plot_style.hpp"
#include "breakaway/report/accuracy_json.hpp"
#include "breakaway/tradeoff/scene_tradeoff.hpp"

namespace breakaway::tradeoff {
namespace {

using scenario::Integrator;

void write_trial(format::JsonWriter& json, const sil::MethodTrial& trial) {
  report::write_method(json, trial.method);
  json.member("error_m", trial.error_m);
  json.member("estimated_cost_s", trial.cost_s);
  json.member("holds", trial.holds);
}

void write_part(format::JsonWriter& json, const LeftOutPart& part, double asked_m) {
  json.member("part", part.name);
  json.member("may_be_left_out", part.may_be_left_out(asked_m));
  json.member("difference_at_the_end_m", part.end_m);
  json.member("difference_on_the_way_m", part.way_m);
  json.member("saves_share", part.saved_share);
  if (!part.impossible.empty()) json.member("impossible", part.impossible);
}

std::string part_line(const LeftOutPart& part, double asked_m) {
  if (!part.impossible.empty()) return fmt::format("  {:<28} cannot be left out: {}\n", part.name, part.impossible);
  const char* verdict = part.may_be_left_out(asked_m) ? "may be left out"
                        : part.end_m <= asked_m       ? "only for the end"
                                                      : "keep it";
  return fmt::format("  {:<28} {:>9.2g} m {:>9.2g} m {:>7.0f} %  {}\n", part.name, part.end_m, part.way_m,
                     100 * part.saved_share, verdict);
}

bool is_chosen(const SceneTradeoff& scene, const sil::Method& method) {
  return scene.choice && scene.choice->method.integrator == method.integrator &&
         scene.choice->method.step_s == method.step_s && scene.choice->method.tolerance == method.tolerance;
}

std::string trial_line(const SceneTradeoff& scene, const sil::MethodTrial& trial) {
  return fmt::format("  {:<44} {:>9.2g} m {:>10.3g} s  {}\n", to_string(trial.method), trial.error_m, trial.cost_s,
                     is_chosen(scene, trial.method) ? "chosen"
                     : trial.holds                  ? "holds"
                                                    : "");
}

constexpr double least_drawn_m = 1e-17;  // what is exact to the last digit is drawn here

// One method's points and how gnuplot draws them; nothing where it has none.
struct Curve {
  std::string data, plot;
};

Curve curve(const SceneTradeoff& scene, Integrator integrator, const char* look) {
  std::string rows;
  for (const sil::MethodTrial& trial : scene.trials) {
    if (trial.method.integrator == integrator)
      rows += fmt::format("{:g} {:g}\n", trial.cost_s, std::fmax(trial.error_m, least_drawn_m));
  }
  if (rows.empty()) return {};
  const char* name = to_string(integrator);
  return {fmt::format("${} << END\n{}END\n", name, rows),
          fmt::format("${0} using 1:2 with {1} title '{0}' noenhanced, ", name, look)};
}

// The scene without each part that can be left out: its distance from the whole, and what it costs.
Curve part_points(const SceneTradeoff& scene) {
  std::string rows;
  for (const LeftOutPart& part : scene.parts) {
    if (!scene.choice || !part.impossible.empty() || !(part.saved_share < 1)) continue;
    rows += fmt::format("{:g} {:g} \"{}\"\n", scene.choice->cost_s * (1 - part.saved_share),
                        std::fmax(part.way_m, least_drawn_m), part.name);
  }
  if (rows.empty()) return {};
  return {fmt::format("$parts << END\n{}END\n", rows),
          "$parts using 1:2 with points linestyle 4 pointtype 2 title 'without a part of the scene', "
          "$parts using 1:2:3 with labels left offset 0.8,0 font ',10' notitle, "};
}

}  // namespace

std::string to_json(const SceneTradeoff& scene) {
  format::JsonWriter json;
  json.object([&] {
    json.member("title", scene.title);
    if (scene.choice) report::write_accuracy(json, *scene.choice);
    if (scene.refusal) {
      json.member("accuracy_m", scene.asked_m);
      json.member("method", std::nan(""));
      json.member("error_estimate_m", std::nan(""));
      report::write_refused(json, scene.refusal->refused());
    }
    json.array("trials", [&] {
      for (const sil::MethodTrial& trial : scene.trials) json.object([&] { write_trial(json, trial); });
    });
    json.array("parts", [&] {
      for (const LeftOutPart& part : scene.parts) json.object([&] { write_part(json, part, scene.asked_m); });
    });
  });
  return json.text();
}

std::string to_table(const SceneTradeoff& scene) {
  std::string text = scene.title.empty() ? "" : scene.title + "\n";
  text += fmt::format("Methods, at {:g} m asked for: error, cost of a run\n", scene.asked_m);
  bool listed = false;
  for (const sil::MethodTrial& trial : scene.trials) {
    text += trial_line(scene, trial);
    listed |= is_chosen(scene, trial.method);
  }
  if (scene.choice && !listed) {
    const sil::Accuracy& c = *scene.choice;
    text += trial_line(scene, {c.method, c.error_estimate_m, c.error_estimate_m, c.cost_s, true});
  }
  if (scene.parts.empty()) return text;
  text += "Parts left out: difference at the end and on the way, processor time saved\n";
  for (const LeftOutPart& part : scene.parts) text += part_line(part, scene.asked_m);
  return text;
}

std::string draw_scene(const std::string& path, const SceneTradeoff& scene) {
  std::string data, plot;
  for (const Curve& part :
       {curve(scene, Integrator::time_stepping, "linespoints linestyle 1 pointtype 7 pointsize 0.6"),
        curve(scene, Integrator::adaptive, "linespoints linestyle 2 pointtype 5 pointsize 0.8"),
        curve(scene, Integrator::event_driven, "points linestyle 3 pointtype 9 pointsize 1.6"), part_points(scene)}) {
    data += part.data;
    plot += part.plot;
  }
  if (scene.choice) {
    data += fmt::format("$choice << END\n{:g} {:g}\nEND\n", scene.choice->cost_s,
                        std::fmax(scene.choice->error_estimate_m, least_drawn_m));
    plot += "$choice using 1:2 with points linestyle 5 pointtype 6 pointsize 3 title 'chosen', ";
  }
  const std::string commands =
      format::plot_style + data + fmt::format("asked = {:g}\n", scene.asked_m) +
      "set logscale xy\nset format xy '10^{%T}'\nset xlabel 'processor time of a run [s]'\n"
      "set ylabel 'largest error of a position [m]'\nset offsets graph 0.08, graph 0.25, graph 0.08, graph 0.05\n"
      "set arrow from graph 0, first asked to graph 1, first asked nohead linestyle 4\nplot " +
      plot + "asked with lines linestyle 4 title 'asked for'\n";
  return format::draw_file(path, format::width_px, 560, commands);
}

}  // namespace breakaway::tradeoff
