// What an accuracy costs on the scenes that the page tells of.
#include "breakaway/sil/axis_accuracy.hpp"
#include "breakaway/sil/method_choice.hpp"
#include "parts.hpp"

namespace breakaway::tradeoff {
namespace {

AskedRow row(const char* scene, const sil::Accuracy& accuracy) {
  return {scene, accuracy.asked_m, to_string(accuracy.method), accuracy.error_estimate_m, accuracy.cost_s};
}

}  // namespace

std::vector<AskedRow> measure_asked() {
  scenario::Scenario axis = can_axis();
  scenario::MachineScenario machine = two_mass_scenario();
  std::vector<AskedRow> rows;
  for (const double accuracy_m : {1e-3, 1e-6, 1e-9}) {
    axis.run->accuracy_m = accuracy_m;
    rows.push_back(row("can_axis.toml", sil::choose_method(axis)));
  }
  // Where the last kick of bristles ends hangs on the last digits, so that finer accuracies are refused.
  scenario::Scenario bristles = can_axis();
  bristles.worlds.front().plant.presliding = model::Presliding{.stiffness_N_per_m = 1e7, .damping_Ns_per_m = 3e3};
  for (const double accuracy_m : {1e-2, 1e-3}) {
    bristles.run->accuracy_m = accuracy_m;
    rows.push_back(row("can_axis.toml with LuGre friction", sil::choose_method(bristles)));
  }
  for (const double accuracy_m : {0.1, 1e-2, 1e-6, 1e-12}) {
    machine.accuracy_m = accuracy_m;
    rows.push_back(row("two_mass_example.toml", sil::choose_method(machine)));
  }
  return rows;
}

std::vector<LeftOutPart> measure_parts_asked() {
  scenario::Scenario axis = can_axis();
  axis.run->accuracy_m = parts_asked_m;
  return measure_scene(axis, {}).parts;
}

}  // namespace breakaway::tradeoff
