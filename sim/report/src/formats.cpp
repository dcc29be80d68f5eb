#include "breakaway/report/formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/report/accuracy_json.hpp"
#include "excursions_json.hpp"

namespace breakaway::report {
namespace {

void write_ideal(format::JsonWriter& json, const sil::IdealFigures& ideal) {
  json.member("t1_s", ideal.t1_s);
  json.member("t2_s", ideal.t2_s);
  json.member("y2_m", ideal.y2_m);
  json.member("t_inf_s", ideal.t_inf_s);
  json.member("t_inf_width_s", ideal.t_inf_width_s);
  json.member("bound_s", ideal.bound_s);
  json.member("steps", ideal.steps);
}

void write_loop(format::JsonWriter& json, const sil::LoopFigures& loop) {
  json.member("ticks", loop.ticks);
  json.member("missed_ticks", loop.missed_ticks);
  json.member("bus_load", loop.bus_load);
  json.member("sync_off_s", loop.sync_off_s);
}

void write_kick(format::JsonWriter& json, const sil::KickRecord& kick, bool ideal) {
  json.member("time_s", kick.time_s);
  json.member("position_m", kick.position_m);
  json.member("error_m", kick.error_m);
  json.member("velocity_after_m_s", kick.velocity_after_m_s);
  if (ideal) {
    json.member("impulse_Ns", kick.impulse_Ns);
  } else {
    json.member("force_N", kick.force_N);
    json.member("periods", kick.periods);
  }
}

void write_faults(format::JsonWriter& json, const std::vector<sil::FaultRecord>& faults) {
  json.array("faults", [&] {
    for (const auto& fault : faults) {
      json.object([&] {
        json.member("time_s", fault.time_s);
        json.member("name", fault.name);
      });
    }
  });
}

void write_axis(format::JsonWriter& json, const config::Axis& described, const sil::AxisResult& axis,
                const std::optional<sil::LoopFigures>& loop) {
  json.member("settled", axis.settled);
  json.member("settling_time_s", axis.settling_time_s);
  json.member("final_error_m", axis.final_error_m);
  if (axis.excursions) write_excursions(json, *axis.excursions);
  json.member("peak_force_N", axis.max_force_N);
  if (axis.excursions) write_margins(json, sil::margins(described, *axis.excursions, axis.max_force_N));
  if (axis.load_position_m) json.member("load_position_m", *axis.load_position_m);
  if (!axis.told.empty()) json.member("told", axis.told);
  if (axis.encoder_noise_seed) json.member("encoder_noise_seed", *axis.encoder_noise_seed);
  if (axis.ideal) write_ideal(json, *axis.ideal);
  if (loop) write_loop(json, *loop);
  json.array("kicks", [&] {
    for (const auto& kick : axis.kicks) json.object([&] { write_kick(json, kick, axis.ideal.has_value()); });
  });
  write_faults(json, axis.faults);
}

void write_axes(format::JsonWriter& json, const config::Node& node, const sil::Result& result) {
  json.member("settled", result.settled());
  if (result.loop) write_loop(json, *result.loop);
  json.array("axes", [&] {
    for (std::size_t i = 0; i < result.axes.size(); ++i) {
      json.object([&] {
        json.member("name", result.axes[i].name);
        write_axis(json, node.axes[i], result.axes[i], {});
      });
    }
  });
}

void write_machine(format::JsonWriter& json, const stability::MachineState<Eigen::Dynamic>& end) {
  json.object("machine", [&] {
    json.numbers("q_end", end.q);
    json.numbers("v_end", end.v);
  });
}

// The coordinates of the machine that all axes stand on.
void append_coordinates(std::string& text, const sil::Result& result, std::size_t sample) {
  if (result.machine_trace.empty()) return;
  for (const double q : result.machine_trace[sample].q) fmt::format_to(std::back_inserter(text), ",{}", q);
}

void append_sample(std::string& text, const sil::Sample& s, bool loads) {
  fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{:.6g},{}", s.time_s, s.position_m, s.velocity_m_s,
                 s.target_m, s.force_N, s.friction_level_N, s.bus_load, law::to_string(s.mode));
  if (loads) fmt::format_to(std::back_inserter(text), ",{}", s.load_position_m.value_or(s.position_m));
}

}  // namespace

std::string to_json(const scenario::Scenario& scenario, const sil::Result& result) {
  format::JsonWriter json;
  json.object([&] {
    json.member("title", scenario.node.title);
    if (result.axes.size() == 1) {
      write_axis(json, scenario.node.axes.front(), result.axes.front(), result.loop);
    } else {
      write_axes(json, scenario.node, result);
    }
    if (result.machine_end) write_machine(json, *result.machine_end);
    json.member("duration_s", result.duration_s);
    json.member("wall_s", result.wall_s);
    if (result.accuracy) write_accuracy(json, *result.accuracy);
  });
  return json.text();
}

std::string to_csv(const scenario::Scenario& scenario, const sil::Result& result) {
  const bool several = scenario.axes() > 1;
  std::string text = several ? "axis," : "";
  // A column that is there only where an axis has a load apart; the position of others is their load's as well.
  const bool loads =
      std::ranges::any_of(result.axes, [](const auto& axis) { return axis.load_position_m.has_value(); });
  text += "time_s,position_m,velocity_m_s,target_m,force_N,friction_level_N,bus_load,mode";
  if (loads) text += ",load_position_m";
  if (result.machine_end)
    for (Eigen::Index i = 1; i <= result.machine_end->q.size(); ++i) text += fmt::format(",q{}", i);
  text += '\n';
  for (const sil::AxisResult& axis : result.axes) {
    for (std::size_t i = 0; i < axis.trace.size(); ++i) {
      if (several) text += axis.name + ',';
      append_sample(text, axis.trace[i], loads);
      append_coordinates(text, result, i);
      text += '\n';
    }
  }
  return text;
}

std::string to_candump(const sil::Result& result) {
  std::string text;
  for (const auto& [time_s, frame] : result.frames) {
    fmt::format_to(std::back_inserter(text), "({:017.6f}) can0 {:03X}#", time_s, frame.id);
    if (frame.remote) {
      fmt::format_to(std::back_inserter(text), "R{}", frame.size);
    } else {
      for (const auto byte : frame.payload()) fmt::format_to(std::back_inserter(text), "{:02X}", byte);
    }
    text += '\n';
  }
  return text;
}

}  // namespace breakaway::report
