// What `breakaway synthesize` found, as text and as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "breakaway/design/synthesis.hpp"
#include "breakaway/machine/resting_batch.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::cli {

// Everything that is reported.
struct Synthesis {
  std::string structure;  // of the gains, as --gains names it
  design::ActuatedSystem system;
  design::PdDesign design;
  std::vector<design::Condition> conditions;
  design::Theorem2 theorem_2;
  std::vector<design::GainSweepRow> sweep;
  scenario::MachineScenario closed_loop;
  double simulated_level_J = 0, simulated_for_s = 0;
  std::uint64_t seed = 1;
  machine::RestingBatch batch;
};

std::string to_json(const Synthesis& s);
void print_summary(const Synthesis& s);

}  // namespace breakaway::cli
