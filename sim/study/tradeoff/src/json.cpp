#include "breakaway/format/json_writer.hpp"
#include "breakaway/tradeoff/frontiers.hpp"

namespace breakaway::tradeoff {
namespace {

using format::JsonWriter;

void write_cost(JsonWriter& json, const Cost& cost) {
  json.member("instructions", cost.instructions);
  json.member("time_ratio", cost.time_ratio);
}

void write_row(JsonWriter& json, const IntegratorRow& row) {
  json.member("method", row.method);
  json.member("step_s", row.step_s);
  json.member("tolerance", row.tolerance);
  json.member("error_m", row.error_m);
  json.member("settling_time_error_s", row.time_error_s);
  json.member("order", row.order);
  json.member("wrong_verdict_share", row.wrong_share);
  json.member("steps", row.steps);
  write_cost(json, row.trajectory);
}
void write_row(JsonWriter& json, const BallRow& row) {
  json.member("step_s", row.step_s);
  json.member("ball_m", row.ball_m);
  json.member("predicted_ball_m", row.predicted_m);
  json.member("kicks_per_step", row.kicks_per_step);
}
void write_row(JsonWriter& json, const EvaluatorRow& row) {
  json.member("method", row.method);
  json.member("scalar", row.scalar);
  json.member("nodes", row.nodes);
  json.member("bytes", row.bytes);
  json.member("relative_error", row.mild_error);
  json.member("relative_error_hard", row.hard_error);
  write_cost(json, row.call);
}
void write_row(JsonWriter& json, const PeriodRow& row) {
  json.member("period_s", row.period_s);
  json.member("accuracy_floor_m", row.floor_m);
  json.member("encoder_resolution_m", row.resolution_m);
  json.member("tolerance_m", row.tolerance_m);
  json.member("worst_error_m", row.worst_error_m);
  json.member("runs", row.runs);
  json.member("settled", row.settled);
}
void write_row(JsonWriter& json, const ScenarioPartRow& row) {
  json.member("scene", row.scenario);
  write_cost(json, row.second);
}

template <class Row>
void write_rows(JsonWriter& json, const char* name, const std::vector<Row>& rows) {
  json.array(name, [&] {
    for (const Row& row : rows) json.object([&] { write_row(json, row); });
  });
}

}  // namespace

std::string to_json(const Frontiers& f) {
  JsonWriter json;
  json.object([&] {
    json.member("quick", f.quick);
    json.member("cost_unit", f.counted ? "instructions" : "time_ratio");
    write_rows(json, "integrators", f.integrators);
    write_rows(json, "impulsive_time_stepping", f.balls);
    write_rows(json, "k3_evaluators", f.evaluators);
    write_rows(json, "control_periods", f.periods);
    write_rows(json, "scene_parts", f.scenario_parts);
  });
  return json.text();
}

}  // namespace breakaway::tradeoff
