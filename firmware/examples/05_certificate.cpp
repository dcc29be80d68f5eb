// Example 5: ask for the certificate of an axis before the machine moves.
//
// Are these gains safe under every friction between the bounds, and how exact will the axis be? `breakaway design`
// answers with a list of checks. The same answer is one call away in C++. The axis is certified when every required
// check holds; the other checks tell more about it and decide nothing.
#include <cstdio>
#include <exception>
#include <string>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/read_node.hpp"

using namespace breakaway;

void show(const char* what, const design::DesignReport& report) {
  std::printf("%s: %s\n", what, report.certified ? "certified" : "NOT certified");
  for (const std::string& reason : report.reasons) std::printf("  %s\n", reason.c_str());
}

int main() try {
  config::Node node = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  config::Axis& axis = node.axes[0];

  const design::DesignReport report = config::examine(node)[0];
  for (const design::Check& check : report.checks)
    std::printf("%-8s %-3s %-38s %s\n", check.required ? "required" : "", check.holds ? "ok" : "no", check.name.c_str(),
                check.source.c_str());
  show("\nfriction from 2.5 N to 4.5 N", report);

  // The guide wears. The report names what does not hold any more, with the figures and the remedy.
  axis.friction.bounds.upper_N = 5;
  const design::DesignReport worn = config::examine(node)[0];
  show("friction from 2.5 N to 5 N", worn);

  // This much is the least error that can be promised on the worn guide.
  axis.controller.position_tolerance_m = worn.accuracy_floor_m;
  const design::DesignReport looser = config::examine(node)[0];
  std::printf("asked for %.2f um instead of 1.8 um, ", 1e6 * worn.accuracy_floor_m);
  show("the same axis", looser);

  return report.certified && !worn.certified && looser.certified ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
