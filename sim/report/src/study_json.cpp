#include "breakaway/report/study_json.hpp"

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/format/json_writer.hpp"
#include "excursions_json.hpp"

namespace breakaway::report {
namespace {

using namespace study;

void write_run(format::JsonWriter& json, const StudyRun& run) {
  json.member("law", run.law);
  json.member("settled", run.settled);
  json.member("settling_time_s", run.settling_time_s);
  json.member("final_error_m", run.final_error_m);
  write_excursions(json, run.excursions);
  json.member("peak_force_N", run.max_force_N);
  json.member("kicks", run.kicks);
  json.member("limit_cycle", run.limit_cycle);
  json.array("faults", [&] {
    for (const sil::FaultRecord& fault : run.faults) json.value(fault.name);
  });
}

void write_row(format::JsonWriter& json, const StudiedAxis& axis, const StudyRow& row) {
  json.member("controller", controller_name(axis.node));
  json.member("scenario", axis.file);
  if (const std::string told = config::told_otherwise(axis.node.axes.front()); !told.empty()) json.member("told", told);
  if (axis.node.axes.front().controller.impulsive)
    json.member(
        "certified",
        config::why_not_certified(axis.node, axis.node.axes.front()).empty() &&
            config::outside_certificate(axis.node.axes.front(), row.start.position_m, row.start.velocity_m_s).empty());
  json.member("position_m", row.start.position_m);
  json.member("velocity_m_s", row.start.velocity_m_s);
  json.member("settled", settled_runs(row));
  json.member("limit_cycles", limit_cycles(row));
  json.member("faulted", faulted_runs(row));
  json.member("median_settling_s", median_settling_time_s(row));
  json.member("worst_settling_s", worst_settling_time_s(row));
  json.member("worst_time_inside_s", worst_time_inside_s(row));
  json.member("worst_law", slowest_run(row).law);
  json.member("worst_error_m", worst_error_m(row));
  write_excursions(json, worst_excursions(row));
  json.member("peak_force_N", largest_force_N(row));
  json.member("sync_off_s", sync_off_s(row));
  write_margins(json, margins(axis.node, row));
  json.array("runs", [&] {
    for (const StudyRun& run : row.runs) json.object([&] { write_run(json, run); });
  });
}

}  // namespace

const char* controller_name(const config::Node& node) { return node.axes.front().controller.pid ? "PID" : "impulsive"; }

std::string to_json(const std::vector<StudiedAxis>& axes, const StudyOptions& options) {
  format::JsonWriter json;
  json.object([&] {
    json.member("random_laws", options.random_laws);
    json.member("seed", options.seed);
    json.array("rows", [&] {
      for (const StudiedAxis& axis : axes) {
        for (const StudyRow& row : axis.rows) json.object([&] { write_row(json, axis, row); });
      }
    });
  });
  return json.text();
}

}  // namespace breakaway::report
