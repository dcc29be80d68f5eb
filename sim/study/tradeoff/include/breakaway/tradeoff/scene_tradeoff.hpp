// Error against cost for a scene of the user's own, a machine or axes, at the accuracy that is asked for: every method
// that can follow it, the one that is chosen, and the parts of the scene that may be left out.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/accuracy.hpp"

namespace breakaway::tradeoff {

// What becomes of the motion when one part of the scene is left out.
struct LeftOutPart {
  std::string name;
  double end_m = 0;        // by how far the positions at the end differ from those of the whole scene
  double way_m = 0;        // the largest difference on the way; of a machine that at the end
  double saved_share = 0;  // of the processor time of a run, measured; below 0: it costs more without
  std::string impossible;  // why it cannot be left out; the figures are NaN then

  bool may_be_left_out(double accuracy_m) const { return impossible.empty() && way_m <= accuracy_m; }
};

struct SceneTradeoff {
  std::string title;
  double asked_m = 0;
  std::vector<sil::MethodTrial> trials;         // from cheap to dear within a method
  std::optional<sil::Accuracy> choice;          // what `simulate` takes
  std::optional<sil::AccuracyRefused> refusal;  // where there is no choice
  std::vector<LeftOutPart> parts;
};

using Progress = std::function<void(const std::string& what)>;

// The scenario's accuracy_m is what is asked for, and required. Throw InputError as simulating does.
SceneTradeoff measure_scene(const scenario::Scenario& scenario, const Progress& progress);
SceneTradeoff measure_scene(const scenario::MachineScenario& scenario, const Progress& progress);

std::string to_json(const SceneTradeoff& scene);
std::string to_table(const SceneTradeoff& scene);  // for people
// The content of the file `path`, an .svg or a .png. Throws InputError without gnuplot.
std::string draw_scene(const std::string& path, const SceneTradeoff& scene);

}  // namespace breakaway::tradeoff
