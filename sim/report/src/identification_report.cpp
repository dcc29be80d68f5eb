#include "breakaway/report/identification_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "breakaway/format/gnuplot.hpp"
#include "breakaway/format/html_page.hpp"
#include "breakaway/format/json_writer.hpp"
#include "breakaway/format/plot_style.hpp"
#include "pictures.hpp"

namespace breakaway::report {
namespace {

using evaluation::FrictionSample;
using evaluation::Identification;
using evaluation::Interval;

double middle(const Interval& interval) { return (interval.least + interval.most) / 2; }

std::string samples_block(const Identification& found, const char* name, int direction, bool at_rest) {
  std::string text = fmt::format("${} << END\n", name);
  for (const FrictionSample& s : found.friction)
    if (s.direction == direction && (s.speed_m_s == 0) == at_rest)
      fmt::format_to(std::back_inserter(text), "{:.7g} {:.6g} {:.6g}\n", s.position_m, middle(s.friction_N),
                     std::abs(s.speed_m_s));
  // gnuplot refuses an empty block.
  return text + "nan nan nan\nEND\n";
}

std::string all_samples(const Identification& found) {
  return samples_block(found, "slides_up", 1, false) + samples_block(found, "slides_down", -1, false) +
         samples_block(found, "breaks_up", 1, true) + samples_block(found, "breaks_down", -1, true);
}

std::string plot_samples(const Identification& found, int column) {
  const Interval& bounds = found.bounds_N;
  return fmt::format(
      "plot $slides_up using {0}:2 with points linecolor '#1c5d99' pointtype 7 pointsize 0.35 title 'sliding, "
      "forward', "
      "$slides_down using {0}:2 with points linecolor '#c8553d' pointtype 7 pointsize 0.35 title 'sliding, backward', "
      "$breaks_up using {0}:2 with points linecolor '#1c5d99' pointtype 9 pointsize 0.9 title 'breaks away, forward', "
      "$breaks_down using {0}:2 with points linecolor '#c8553d' pointtype 11 pointsize 0.9 title 'breaks away, "
      "backward', "
      "{1:.6g} with lines linestyle 4 title 'bounds', {2:.6g} with lines linestyle 4 notitle\n",
      column, bounds.least, bounds.most);
}

Picture friction_over_place(const Identification& found) {
  const std::string commands = format::plot_style + all_samples(found) +
                               fmt::format(
                                   "set xlabel 'position [m]'\nset ylabel 'friction [N]'\nset yrange [0:{:.6g}]\n"
                                   "set key width -3\n",
                                   1.1 * found.bounds_N.most) +
                               plot_samples(found, 1);
  return {
      "Friction over the place",
      fmt::format("Each point is the middle of what friction may have been once: from a parabola through the positions "
                  "while it slid, from the force of a slow ramp where it broke away. The bounds are those of the file, "
                  "{:g} % beyond the least and the greatest that it may have been.",
                  100 * found.margins.friction),
      format::draw_svg("friction", format::width_px, 380, commands)};
}

Picture friction_over_speed(const Identification& found) {
  const std::string commands = format::plot_style + all_samples(found) +
                               fmt::format(
                                   "set xlabel 'speed [m/s]'\nset ylabel 'friction [N]'\n"
                                   "set yrange [0:{:.6g}]\nset xrange [0:*]\nset key width -3\n",
                                   1.1 * found.bounds_N.most) +
                               plot_samples(found, 3);
  return {"Friction over the speed", "The same points. A rise towards rest is what makes an axis stick.",
          format::draw_svg("friction_speed", format::width_px, 340, commands)};
}

// The least and the greatest of each stretch, so that no pulse is lost.
std::string record_block(const evaluation::Record& record) {
  constexpr std::size_t most_stretches = 1500;
  const std::size_t n = record.readings.size(), length = std::max<std::size_t>(n / most_stretches, 1);
  std::string text = "$record << END\n";
  for (std::size_t first = 0; first < n; first += length) {
    const auto stretch = record.readings.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = stretch + static_cast<std::ptrdiff_t>(std::min(length, n - first));
    const auto [least, most] =
        std::minmax_element(stretch, end, [](const auto& a, const auto& b) { return a.command_N < b.command_N; });
    const double time_s = static_cast<double>(first) * record.period_s;
    fmt::format_to(std::back_inserter(text), "{:.6g} {:.7g} {:.5g}\n{:.6g} {:.7g} {:.5g}\n", time_s,
                   stretch->position_m, least->command_N, time_s, stretch->position_m, most->command_N);
  }
  return text + "END\n";
}

Picture experiment_over_time(const evaluation::Record& record) {
  const std::string commands =
      format::plot_style + record_block(record) +
      "set multiplot layout 2,1\nset xrange [0:*]\nset ylabel 'position [m]'\nset format x ''\nset bmargin 1\n"
      "plot $record using 1:2 with lines linestyle 1 notitle\n"
      "set ylabel 'force [N]'\nset format x '%g'\nset xlabel 'time [s]'\nset bmargin 3.5\nset tmargin 0.5\n"
      "plot $record using 1:3 with lines linestyle 2 linewidth 1 notitle\nunset multiplot\n";
  return {"The experiment",
          "What the loop read and commanded: pulses that grow, slow ramps, pairs of accelerating and braking, and hops "
          "over the travel in both directions.",
          format::draw_svg("experiment", format::width_px, 460, commands)};
}

void spring_rows(const evaluation::SpringEstimate& spring, const Identification& found, format::HtmlTable& table) {
  const auto range = [](const Interval& interval, const char* unit) {
    return fmt::format("{:.4g} to {:.4g} {}", interval.least, interval.most, unit);
  };
  table.row("Load on a spring", fmt::format("{:.4g} kg behind a motor of {:.4g} kg, swings at {}", spring.load_kg,
                                            spring.motor_kg, range(spring.resonance_Hz, "Hz")));
  table.row("Stiffness, at least", fmt::format("{:.3g} N/m, {:g} % below the least of {} in {} switches of the force",
                                               spring.stiffness_N_per_m, 100 * found.margins.stiffness,
                                               range(spring.stiffness_seen_N_per_m, "N/m"), spring.switches));
  table.row("Chance that another switch shows less stiffness than any",
            fmt::format("at most {:.2g} %", 100 * spring.chance_softer()));
  table.row("Damping of the spring, at least", fmt::format("{:.2g} N s/m", spring.damping_Ns_per_m));
  table.row("Friction of the motor alone, of the load alone",
            fmt::format("{}, {}, with a margin of {:g} %, in {} bends of the spring", range(spring.motor_N, "N"),
                        range(spring.load_N, "N"), 100 * found.margins.side, spring.bends));
}

std::string results(const study::IdentifiedRun& run) {
  const Identification& found = run.found;
  format::HtmlTable table;
  table.row("Evaluated", run.source);
  table.row("Experiment", fmt::format("{:.1f} s, {}", found.duration_s, run.ending));
  table.row("Mass", fmt::format("{:.4g} kg ± {:.1f} %, from {} switches of the force in motion", found.mass.mass_kg,
                                100 * found.mass_uncertainty, found.mass.switches));
  table.row("Friction seen", fmt::format("{:.4g} to {:.4g} N in {} motions", found.friction_seen_N.least,
                                         found.friction_seen_N.most, found.motions));
  table.row("Bounds", fmt::format("{:.4g} to {:.4g} N, with a margin of {:g} %", found.bounds_N.least,
                                  found.bounds_N.most, 100 * found.margins.friction));
  if (found.spring) spring_rows(*found.spring, found, table);
  const evaluation::LatencyEstimate& latency = found.latency;
  table.row("Latency", latency.is_told_apart()
                           ? fmt::format("{} × control period", latency.periods)
                           : fmt::format("{} to {} × control period", latency.fewest_periods, latency.most_periods));
  if (!latency.is_told_apart())
    table.row("Current loop",
              fmt::format("not told apart from the latency; together {:.3g} ms", 1e3 * latency.delay_s));
  else if (latency.lag_is_seen)
    table.quantity("Current loop, time constant", 1e3 * found.latency.lag_s, "ms");
  else
    table.row("Current loop", "too fast to be seen");
  if (found.presliding_N_per_m) table.quantity("Stiffness before it slides", *found.presliding_N_per_m, "N/m");
  table.row("Chance that another motion shows friction outside what was seen",
            fmt::format("at most {:.2g} %, whatever its distribution", 100 * found.chance_outside()));
  return table.text();
}

void write_interval(format::JsonWriter& json, std::string_view name, const Interval& interval) {
  json.array(name, [&] {
    json.value(interval.least);
    json.value(interval.most);
  });
}

void write_samples(format::JsonWriter& json, const Identification& found) {
  json.array("friction", [&] {
    for (const FrictionSample& s : found.friction)
      json.object([&] {
        json.member("position_m", s.position_m);
        json.member("speed_m_s", s.speed_m_s);
        json.member("direction", s.direction);
        json.member("motion", s.motion);
        write_interval(json, "friction_N", s.friction_N);
      });
  });
}

void write_spring(format::JsonWriter& json, const evaluation::SpringEstimate& spring) {
  json.object("spring", [&] {
    json.member("motor_kg", spring.motor_kg);
    json.member("load_kg", spring.load_kg);
    write_interval(json, "resonance_Hz", spring.resonance_Hz);
    json.member("stiffness_N_per_m", spring.stiffness_N_per_m);
    write_interval(json, "stiffness_seen_N_per_m", spring.stiffness_seen_N_per_m);
    json.member("chance_softer", spring.chance_softer());
    json.member("damping_Ns_per_m", spring.damping_Ns_per_m);
    write_interval(json, "motor_friction_bounds_N", spring.motor_N);
    write_interval(json, "load_friction_bounds_N", spring.load_N);
    json.member("switches", spring.switches);
    json.member("bends", spring.bends);
  });
}

}  // namespace

std::string identification_html(const study::IdentifiedRun& run) {
  std::string sections =
      format::html_section("What was found", results(run),
                           "Mass and friction are in units of the force that was commanded: where the drive gives more "
                           "or less than it says, "
                           "both are off by the same share, and what is designed from them is right again.");
  for (const Picture& picture :
       {friction_over_place(run.found), friction_over_speed(run.found), experiment_over_time(run.record)})
    sections += format::html_section(picture.title, picture.svg, picture.caption);
  return format::html_page(run.title, run.complete, run.complete ? "identified" : run.ending, sections);
}

std::string identification_json(const study::IdentifiedRun& run) {
  const Identification& found = run.found;
  format::JsonWriter json;
  json.object([&] {
    json.member("title", run.title);
    json.member("ending", run.ending);
    json.member("complete", run.complete);
    json.member("duration_s", found.duration_s);
    json.member("mass_kg", found.mass.mass_kg);
    json.member("mass_uncertainty", found.mass_uncertainty);
    write_interval(json, "mass_seen_kg", found.mass.seen_kg);
    json.member("switches", found.mass.switches);
    write_interval(json, "friction_seen_N", found.friction_seen_N);
    write_interval(json, "friction_bounds_N", found.bounds_N);
    json.member("friction_margin", found.margins.friction);
    write_interval(json, "travel_seen_m", found.travel_seen_m);
    json.member("motions", found.motions);
    json.member("chance_outside", found.chance_outside());
    json.member("latency_periods", found.latency.periods);
    json.array("latency_range_periods", [&] {
      json.value(found.latency.fewest_periods);
      json.value(found.latency.most_periods);
    });
    json.member("current_loop_time_constant_s", found.latency.lag_is_seen ? found.latency.lag_s : NAN);
    json.member("presliding_stiffness_N_per_m", found.presliding_N_per_m.value_or(NAN));
    if (found.spring) write_spring(json, *found.spring);
    write_samples(json, found);
  });
  return json.text();
}

}  // namespace breakaway::report
