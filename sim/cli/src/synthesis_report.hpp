// What `breakaway synthesize` found, as text and as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/stability/synthesis.hpp"
#include "breakaway/study/resting_batch.hpp"

namespace breakaway::cli {

// Everything that is reported.
struct Synthesis {
  std::string structure;  // of the gains, as --gains names it
  stability::ActuatedSystem system;
  stability::PdDesign design;
  std::vector<stability::Condition> conditions;
  stability::Theorem2 theorem_2;
  std::vector<stability::GainSweepRow> sweep;
  scenario::MachineScenario closed_loop;
  double simulated_level_J = 0, simulated_for_s = 0;
  std::uint64_t seed = 1;
  study::RestingBatch batch;
};

std::string to_json(const Synthesis& s);
void print_summary(const Synthesis& s);

}  // namespace breakaway::cli
