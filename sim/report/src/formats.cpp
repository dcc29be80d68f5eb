#include "breakaway/report/formats.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "breakaway/format/json_writer.hpp"

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

}  // namespace

std::string to_json(const scenario::Scenario& scene, const sil::Result& result) {
  format::JsonWriter json;
  json.object([&] {
    json.member("title", scene.title);
    json.member("settled", result.settled);
    json.member("settling_time_s", result.settling_time_s);
    json.member("final_error_m", result.final_error_m);
    json.member("max_force_N", result.max_force_N);
    if (result.ideal) write_ideal(json, *result.ideal);
    if (result.loop) write_loop(json, *result.loop);
    json.array("kicks", [&] {
      for (const auto& kick : result.kicks) json.object([&] { write_kick(json, kick, result.ideal.has_value()); });
    });
    json.array("faults", [&] {
      for (const auto& fault : result.faults) {
        json.object([&] {
          json.member("time_s", fault.time_s);
          json.member("name", fault.name);
        });
      }
    });
    json.member("duration_s", result.duration_s);
    json.member("wall_s", result.wall_s);
  });
  return json.text();
}

std::string to_csv(const sil::Result& result) {
  std::string text = "time_s,position_m,velocity_m_s,target_m,force_N,friction_level_N,bus_load,mode\n";
  for (const auto& s : result.trace) {
    fmt::format_to(std::back_inserter(text), "{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.6g},{}\n", s.time_s,
                   s.position_m, s.velocity_m_s, s.target_m, s.force_N, s.friction_level_N, s.bus_load,
                   law::to_string(s.mode));
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
