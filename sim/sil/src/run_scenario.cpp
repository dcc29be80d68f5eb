#include "breakaway/sil/run_scenario.hpp"

#include <fmt/format.h>

#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/run_bus_scenario.hpp"
#include "breakaway/sil/run_ideal_scenario.hpp"

namespace breakaway::sil {
namespace {

void require(const scenario::Scenario& s, bool holds, const std::string& otherwise) {
  if (!holds) throw InputError{s.file.empty() ? otherwise : s.file + ": " + otherwise};
}

void check_ideal(const scenario::Scenario& s) {
  require(s, !s.drive && !s.bus, "[loop] is missing: a scene with a [drive] needs it");
  require(s, s.controller.impulsive.has_value(),
          "[loop] is missing: a pid controller runs in a loop only, with a [drive]");
  require(s, s.controller.impulsive->kick == scenario::Kick::ideal,
          "[controller] kick must be \"ideal\" in a scene without [loop]");
  require(s,
          s.controller.max_force_N == scenario::unlimited &&
              s.controller.max_approach_speed_m_s == scenario::unlimited && s.controller.position_tolerance_m == 0,
          "[controller] max_force_N, max_approach_speed_m_s and position_tolerance_m need a [loop]: the ideal law has "
          "none");
}

void check_loop(const scenario::Scenario& s) {
  require(s, s.drive.has_value(), "[drive] is missing: a scene with a [loop] needs it");
  require(s, s.controller.max_force_N < scenario::unlimited,
          "[controller] max_force_N is missing: a scene with a [drive] needs a limit that the drive can give");
  require(
      s, s.controller.max_force_N > s.friction.upper_N,
      fmt::format("[controller] max_force_N is {}, must exceed the upper friction bound {} N, or no kick is sure to "
                  "move the axis",
                  s.controller.max_force_N, s.friction.upper_N));
  require(
      s, s.controller.max_force_N <= scenario::drive_force_N(*s.drive) * (1 + 1e-12),
      fmt::format("[controller] max_force_N is {}, but the [drive] gives {:.6g} N at most: lower it, or give the drive "
                  "more torque",
                  s.controller.max_force_N, scenario::drive_force_N(*s.drive)));
  require(s, s.run->settle_tolerance_m > 0,
          "[run] settle_tolerance_m is missing: say within which error a scene with a [loop] counts as settled");
}

}  // namespace

void require_complete(const scenario::Scenario& s) {
  require(s, s.run.has_value(), "[run] is missing: say how long to simulate with duration_s");
  s.ideal() ? check_ideal(s) : check_loop(s);
}

Result run_scenario(const scenario::Scenario& s, const RecordingOptions& recording) {
  require_complete(s);
  return s.ideal() ? run_ideal_scenario(s, recording) : run_bus_scenario(s, recording);
}

}  // namespace breakaway::sil
