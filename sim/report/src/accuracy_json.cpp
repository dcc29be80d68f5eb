#include "breakaway/report/accuracy_json.hpp"

#include <cmath>

namespace breakaway::report {

void write_method(format::JsonWriter& json, const sil::Method& method) {
  json.object("method", [&] {
    json.member("name", scenario::to_string(method.integrator));
    if (method.step_s > 0) json.member("step_s", method.step_s);
    if (method.tolerance > 0) json.member("tolerance", method.tolerance);
  });
}

void write_refused(format::JsonWriter& json, const std::vector<sil::MethodRefusal>& refused) {
  json.array("refused", [&] {
    for (const sil::MethodRefusal& refusal : refused) {
      json.object([&] {
        write_method(json, refusal.method);
        json.member("reason", refusal.reason);
        json.member("estimated_cost_s", refusal.cost_s);
      });
    }
  });
}

void write_accuracy(format::JsonWriter& json, const sil::Accuracy& accuracy) {
  json.member("accuracy_m", accuracy.asked_m);
  write_method(json, accuracy.method);
  json.member("error_estimate_m", accuracy.error_estimate_m);
  json.member("estimated_cost_s", accuracy.cost_s);
  write_refused(json, accuracy.refused);
}

std::string to_json(const sil::AccuracyRefused& refusal) {
  format::JsonWriter json;
  json.object([&] {
    json.member("accuracy_m", refusal.asked_m());
    json.member("method", std::nan(""));
    json.member("error_estimate_m", std::nan(""));
    write_refused(json, refusal.refused());
  });
  return json.text();
}

}  // namespace breakaway::report
