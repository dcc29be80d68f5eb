#include "plant_budget.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace breakaway::sil {
namespace {

using scenario::AxisWorld;

// Whether it changes on the way, smoothly or by jumps.
bool changes(const model::FrictionLaw& law) {
  return !law.constant_between_events() || std::isfinite(law.range_m().lower_m) ||
         std::isfinite(law.range_m().upper_m) || law.next_time_change_s() < std::numeric_limits<double>::infinity();
}

// The keys of what asks for short steps.
std::vector<std::string> costly_keys(const AxisWorld& world) {
  std::vector<std::string> keys;
  const auto name = [&](bool costly, const char* key) {
    if (costly) keys.emplace_back(key);
  };
  const model::CompliantPlant& plant = world.plant;
  name(changes(world.friction), "[friction] law");
  name(world.drift.has_value(), "[plant] drift");
  name(plant.presliding.has_value(), "[plant] presliding");
  name(plant.load.has_value(), "[plant] load");
  name(plant.load && plant.load->coupling.gap_m > 0, "[plant] backlash");
  name(plant.cogging.amplitude != 0, "[plant] cogging");
  name(plant.ripple.amplitude != 0, "[plant] ripple");
  return keys;
}

// All axes' keys, each once.
std::string costly_keys(const scenario::Scenario& s) {
  std::string listed;
  for (const AxisWorld& world : s.worlds) {
    for (const std::string& key : costly_keys(world)) {
      if (listed.find(key) == std::string::npos) listed += (listed.empty() ? "" : ", ") + key;
    }
  }
  return listed;
}

}  // namespace

motion::WorkBudget plant_budget(const scenario::Scenario& s) {
  const double duration_s = s.run->duration_s;
  const double periods = s.ideal() ? 0 : duration_s / s.node.period_s();
  const motion::WorkBudget::Run run{duration_s, periods, s.run->stop_when_settled};
  if (s.machine)
    return {run, "the [machine]", "its directions stick and slip, or vibrate, so often",
            "shorten [run] duration_s, or damp what vibrates"};
  const std::string keys = costly_keys(s);
  return {run, s.axes() > 1 ? "the axes" : "the axis",
          keys.empty() ? "sticking and slipping so often" : keys + ": so short are the steps that this asks for",
          keys.empty() ? "shorten [run] duration_s"
                       : "shorten [run] duration_s, or make slower or softer what changes so fast, or leave it out"};
}

}  // namespace breakaway::sil
