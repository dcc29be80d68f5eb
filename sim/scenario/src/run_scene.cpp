#include "breakaway/scenario/run_scene.hpp"

#include "breakaway/scenario/input_error.hpp"
#include "breakaway/scenario/run_bus_scene.hpp"
#include "breakaway/scenario/run_ideal_scene.hpp"

namespace breakaway::scenario {
namespace {

void require(bool holds, const char* otherwise) {
  if (!holds) throw InputError{otherwise};
}

void check_ideal(const Scenario& s) {
  require(!s.drive && !s.bus, "[loop] is missing: a scene with a [drive] needs it");
  require(s.controller.impulsive.has_value(),
          "[loop] is missing: a pid controller runs in a loop only, with a [drive]");
  require(s.controller.impulsive->kick == Kick::ideal, "[controller] kick must be \"ideal\" in a scene without [loop]");
  require(s.controller.max_force_N == unlimited && s.controller.max_approach_speed_m_s == unlimited &&
              s.controller.position_tolerance_m == 0,
          "[controller] max_force_N, max_approach_speed_m_s and position_tolerance_m need a [loop]: the ideal law has "
          "none");
}

}  // namespace

Result run_scene(const Scenario& s, const RecordingOptions& recording) {
  require(s.run.has_value(), "[run] is missing: say how long to simulate with duration_s");
  if (s.ideal()) {
    check_ideal(s);
    return run_ideal_scene(s, recording);
  }
  require(s.drive.has_value(), "[drive] is missing: a scene with a [loop] needs it");
  return run_bus_scene(s, recording);
}

}  // namespace breakaway::scenario
