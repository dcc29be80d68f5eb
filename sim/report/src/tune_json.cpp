#include "breakaway/report/tune_json.hpp"

#include "breakaway/format/json_writer.hpp"

namespace breakaway::report {
namespace {

using study::DoubledLimit;
using study::Gains;
using study::TunedPoint;
using study::Tuning;

const char* coast_name(law::Coast coast) {
  return coast == law::Coast::pd ? "pd" : coast == law::Coast::brake ? "brake" : "work";
}

void write_gains(format::JsonWriter& json, const Gains& gains) {
  json.member("coast", coast_name(gains.coast));
  json.member("k1_N_per_m", gains.stiffness_N_per_m);
  json.member("k21_Ns_per_m", gains.approach_damping_Ns_per_m);
  json.member("k22_Ns_per_m", gains.kick_damping_Ns_per_m);
  json.member("max_force_N", gains.max_force_N);
  json.member("max_approach_speed_m_s", gains.max_approach_speed_m_s);
  if (gains.move) {
    json.member("move_speed_m_s", gains.move->speed_m_s);
    json.member("move_acceleration_m_s2", gains.move->acceleration_m_s2);
  }
  json.member("position_tolerance_m", gains.position_tolerance_m);
  json.member("settle_tolerance_m", gains.settle_tolerance_m);
}

void write_point(format::JsonWriter& json, const TunedPoint& point) {
  write_gains(json, point.gains);
  json.member("why_not", point.why_not);
  json.member("laws", point.laws);
  json.member("error_m", point.error_m);
  json.member("worst_settling_s", point.worst_settling_s);
  json.member("median_settling_s", point.median_settling_s);
  json.member("overshoot_m", point.overshoot_m);
  json.member("peak_force_N", point.peak_force_N);
}

void write_limit(format::JsonWriter& json, const DoubledLimit& limit) {
  json.member("name", limit.name);
  json.member("change", limit.change);
  json.member("why_not", limit.why_not);
  json.member("saves", limit.gain);
  json.member("worst_settling_s", limit.best.worst_settling_s);
  json.member("peak_force_N", limit.best.peak_force_N);
  json.member("least_tolerance_m", limit.least_tolerance_m);
}

}  // namespace

std::string to_json(const Tuning& tuning) {
  format::JsonWriter json;
  json.object([&] {
    json.member("objective", study::to_string(tuning.objective));
    json.member("distance_m", tuning.distance_m);
    json.member("least_tolerance_m", tuning.least_tolerance_m);
    json.member("least_time_s", tuning.least_time_s);
    json.object("chosen", [&] { write_point(json, tuning.chosen); });
    json.array("numbers", [&] {
      for (const study::ChosenNumber& number : tuning.numbers) {
        json.object([&] {
          json.member("key", number.key);
          json.member("value", number.value);
          json.member("why", number.why);
        });
      }
    });
    json.array("limits", [&] {
      for (const DoubledLimit& limit : tuning.limits) json.object([&] { write_limit(json, limit); });
    });
    json.array("tried", [&] {
      for (const TunedPoint& point : tuning.tried) json.object([&] { write_point(json, point); });
    });
  });
  return json.text();
}

}  // namespace breakaway::report
