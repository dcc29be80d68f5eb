// What an accuracy that is asked for leads to, as members of a JSON object.
#pragma once

#include <string>
#include <vector>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/sil/accuracy.hpp"

namespace breakaway::report {

// "method": {"name", "step_s" or "tolerance" where it has one}.
void write_method(format::JsonWriter& json, const sil::Method& method);

// "refused": [{"method", "reason", "estimated_cost_s"}].
void write_refused(format::JsonWriter& json, const std::vector<sil::MethodRefusal>& refused);

// "accuracy_m", "method", "error_estimate_m", "estimated_cost_s" and "refused".
void write_accuracy(format::JsonWriter& json, const sil::Accuracy& accuracy);

// The document where no method holds: the same members, null where there is nothing to say.
std::string to_json(const sil::AccuracyRefused& refusal);

}  // namespace breakaway::report
