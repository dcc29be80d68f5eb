#include "breakaway/report/design_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/design/binding_limit.hpp"
#include "breakaway/format/json_writer.hpp"
#include "breakaway/report/conditions_json.hpp"

namespace breakaway::report {
namespace {

using config::Node;
using design::DesignReport;

void write_check(format::JsonWriter& json, const design::Check& check) {
  json.member("name", check.name);
  json.member("required", check.required);
  json.member("holds", check.holds);
  json.member("margin", check.margin);
  json.member("source", check.source);
  json.member("reason", check.reason);
}

// What simulate and study see of an axis that sets off at rest, at most: by kicks and by approaches.
void write_promised_excursions(format::JsonWriter& json, double overshoot_m, double beyond_m, double kick_peak_m_s,
                               double approach_peak_m_s) {
  json.member("overshoot_m", overshoot_m);
  json.member("beyond_m", beyond_m);
  json.member("kick_peak_m_s", kick_peak_m_s);
  if (!std::isfinite(approach_peak_m_s)) return;  // nothing limits it
  json.member("approach_peak_m_s", approach_peak_m_s);
  json.member("peak_speed_m_s", std::max(kick_peak_m_s, approach_peak_m_s));
}

void write_promised_excursions(format::JsonWriter& json, const auto& promise) {
  write_promised_excursions(json, std::max(promise.beyond_m, promise.approach_beyond_m), promise.beyond_m,
                            promise.kick_peak_m_s, promise.approach_peak_m_s);
  json.member("approach_beyond_m", promise.approach_beyond_m);
}

void write_promise(format::JsonWriter& json, const design::BrakedPromise& promise) {
  json.member("accuracy_floor_m", promise.floor_m);
  json.member("least_tolerance_m", promise.least_tolerance_m);
  json.member("error_m", promise.error_m);
  write_promised_excursions(json, promise);
  json.member("reach_m", promise.reach_m);
  json.member("hand_over_m", promise.hand_over_m);
  json.member("most_kicks", promise.most_kicks);
  json.member("kicks_s", promise.kicks_s);
  json.member("fine_stage", promise.fine_stage);
  json.member("brake_N", promise.brake_N);
  json.member("rest_s", promise.rest_s);
  json.member("aim_lost", promise.aim_lost);
  json.member("table_bytes", promise.table_bytes);
  if (promise.approach_s > 0) {
    json.member("longest_way_m", promise.longest_way_m);
    json.member("approach_s", promise.approach_s);
  }
  if (promise.least_move_s > 0) {
    json.member("least_move_s", promise.least_move_s);
  }
}

void write_promise(format::JsonWriter& json, const design::PdPromise& promise, double kick_peak_m_s) {
  json.member("most_kicks", promise.most_kicks);
  json.member("aim_lost", promise.aim_lost);
  json.member("error_m", promise.error_m);
  json.member("kicks_s", promise.kicks_s);
  if (!std::isfinite(promise.beyond_m)) return;
  write_promised_excursions(json, promise.beyond_m, promise.beyond_m, kick_peak_m_s, promise.approach_peak_m_s);
  json.member("longest_way_m", promise.longest_way_m);
  json.member("approach_s", promise.approach_s);
}

void write_promise(format::JsonWriter& json, const design::WorkPromise& promise) {
  json.member("accuracy_floor_m", promise.floor_m);
  json.member("least_tolerance_m", promise.least_tolerance_m);
  json.member("error_m", promise.error_m);
  write_promised_excursions(json, promise);
  json.member("spring_m", promise.spring_m);
  json.member("unseen_m", promise.unseen_m);
  json.member("resonance_Hz", promise.resonance_Hz);
  json.member("reach_m", promise.reach_m);
  json.member("hand_over_m", promise.hand_over_m);
  json.member("farthest_m", promise.farthest_m);
  json.member("most_kicks", promise.most_kicks);
  json.member("rest_s", promise.rest_s);
  json.member("table_bytes", promise.table_bytes);
}

void write_report(format::JsonWriter& json, const config::Axis& axis, const DesignReport& report) {
  json.member("certified", report.certified);
  json.array("reasons", [&] {
    for (const std::string& reason : report.reasons) json.value(reason);
  });
  json.array("conditions", [&] {
    for (const std::string& condition : report.conditions) json.value(condition);
  });
  json.member("zeta_approach", report.zeta_approach);
  json.member("zeta_kick", report.zeta_kick);
  json.member("c_lower_m", report.c_lower_m);
  json.member("c_upper_m", report.c_upper_m);
  json.member("friction_ratio", report.ratio);
  json.member("friction_ratio_threshold_18", report.ratio_threshold_18);
  json.member("friction_ratio_exact_threshold", report.exact_ratio_threshold);
  json.member("least_k22_for_18_Ns_per_m", report.least_damping_Ns_per_m);
  json.member("largest_impulse_Ns", report.largest_impulse_Ns);
  json.member("contraction_per_kick", report.contraction_per_kick);
  json.member("accuracy_floor_m", report.accuracy_floor_m);
  json.member("bound_s", report.finite_time_bound_s);
  json.object("table", [&] {
    json.member("bytes", report.table_bytes);
    json.member("proved_error", report.table_proved_error);
    json.member("measured_error", report.table_measured_error);
  });
  if (report.braked) json.object("braked", [&] { write_promise(json, *report.braked); });
  if (report.work) json.object("work", [&] { write_promise(json, *report.work); });
  if (report.pd && report.certified)
    json.object("pd", [&] { write_promise(json, *report.pd, config::kick_peak_m_s(axis, report)); });
  json.array("checks", [&] {
    for (const design::Check& check : report.checks) json.object([&] { write_check(json, check); });
  });
}

void write_axis(format::JsonWriter& json, const Node& node, const config::Axis& axis, const DesignReport& report) {
  write_report(json, axis, report);
  if (report.braked && report.certified) {
    const design::BindingLimit limit = design::binding_limit(config::braked_class(node, axis));
    json.member("limited_by", std::string{limit.name});
    json.member("least_tolerance_with_half_m", limit.least_tolerance_m);
  }
  if (const std::string told = config::told_otherwise(axis); !told.empty()) json.member("told", told);
}

void write_pair(format::JsonWriter& json, const Node& node, const stability::PairCondition& pair) {
  json.member("kicked", node.axes[static_cast<std::size_t>(pair.kicked)].name);
  json.member("held", node.axes[static_cast<std::size_t>(pair.held)].name);
  json.member("phase", std::string{stability::to_string(pair.phase)});
  json.member("needed_N", pair.needed_N);
  json.member("held_N", pair.held_N);
  json.member("margin_N", pair.margin_N());
}

void write_promised_axis(format::JsonWriter& json, const Node& node, std::size_t i,
                         const stability::MachineCertificate& certificate) {
  const stability::AxisPromise& axis = certificate.axes[i];
  json.member("name", node.axes[i].name);
  json.member("box_m", axis.box_m);
  json.member("kick_N", axis.kick_N);
  json.member("accuracy_floor_m", axis.floor_m);
  json.member("least_tolerance_m", axis.least_tolerance_m);
  json.member("error_m", config::tolerance_m(node, node.axes[i]) + config::reading_error_m(node.axes[i]));
  json.member("most_kicks", axis.most_kicks);
  json.object("tightest", [&] { write_pair(json, node, axis.tightest); });
}

}  // namespace

std::string to_json(const Node& node, const std::vector<DesignReport>& reports) {
  format::JsonWriter json;
  json.object([&] {
    if (reports.size() == 1) return write_axis(json, node, node.axes.front(), reports.front());
    json.member("certified", std::ranges::all_of(reports, &DesignReport::certified));
    json.array("axes", [&] {
      for (std::size_t i = 0; i < reports.size(); ++i) {
        json.object([&] {
          json.member("name", node.axes[i].name);
          write_axis(json, node, node.axes[i], reports[i]);
        });
      }
    });
  });
  return json.text();
}

std::string to_json(const Node& node, const stability::MachineCertificate& certificate) {
  format::JsonWriter json;
  json.object([&] {
    json.member("certified", certificate.certified);
    json.member("reason", certificate.reason);
    write_conditions(json, certificate.conditions);
    json.member("start_J", certificate.sampled.start_J);
    json.member("level_J", certificate.sampled.level_J);
    json.numbers("friction_lost_to_sampling_N", certificate.sampled.lost_N);
    json.member("release_s", certificate.release_s);
    json.member("most_kicks", certificate.most_kicks);
    json.array("axes", [&] {
      for (std::size_t i = 0; i < certificate.axes.size(); ++i)
        json.object([&] { write_promised_axis(json, node, i, certificate); });
    });
    json.array("simultaneous", [&] {
      for (const stability::PairCondition& pair : certificate.simultaneous)
        json.object([&] { write_pair(json, node, pair); });
    });
  });
  return json.text();
}

}  // namespace breakaway::report
