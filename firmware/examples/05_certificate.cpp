// Example 5: ask for the certificate of an axis before the machine moves.
//
// Are these gains safe under every friction between the bounds, and how exact will the axis be? `breakaway design`
// answers with a list of checks. The same answer is one call away in C++. The axis is certified when every required
// check holds; the other checks tell more about it and decide nothing.
#include <cstdio>
#include <exception>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/read_node.hpp"

using namespace breakaway;

int main() try {
  config::Node node = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");

  const design::DesignReport report = config::examine(node)[0];
  for (const design::Check& check : report.checks)
    std::printf("%-8s %-3s %-38s %s\n", check.required ? "required" : "", check.holds ? "ok" : "no", check.name.c_str(),
                check.source.c_str());
  std::printf("%s, exact to %.2f um\n", report.certified ? "certified" : "NOT certified",
              1e6 * report.accuracy_floor_m);

  // How far may friction rise, as the guide wears, before the certificate is gone?
  law::FrictionBounds<double>& friction = node.axes[0].friction.bounds;
  while (config::examine(node)[0].certified && friction.upper_N < 50) friction.upper_N += 0.1;
  std::printf("certified until the friction may rise to %.1f N", friction.upper_N);
  for (const design::Check& check : config::examine(node)[0].checks)
    if (check.required && !check.holds) std::printf("; then fails: %s (%s)", check.name.c_str(), check.reason.c_str());
  std::printf("\n");
  return report.certified && friction.upper_N > 4.5 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
