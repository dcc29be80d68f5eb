// Example 5: the certificate of an axis, from C++.
//
// `breakaway design` answers before a machine moves: are these gains safe for every friction between the bounds, and how exact will the axis
// be? The same answer is one call away, with every check, its source
// and its margin. Required checks decide; the others are sufficient conditions, shown for information.
#include <cstdio>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/read_node.hpp"

using namespace breakaway;

int main() {
  config::Node node = config::read_node(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  config::Axis& axis = node.axes[0];

  const design::DesignReport report = config::examine(node)[0];
  for (const design::Check& check : report.checks)
    std::printf("%-4s %-55s %s\n", check.holds ? "ok" : "no", check.name.c_str(), check.source.c_str());
  std::printf("%s\n\n", report.certified ? "certified" : "not certified");

  // The same axis in a dusty room: how far may its friction rise before the certificate is gone?
  double certified_up_to_N = 0;
  for (double upper_N = 3; config::examine(node)[0].certified; upper_N += 0.5) {
    certified_up_to_N = axis.friction.bounds.upper_N;
    axis.friction.bounds.upper_N = upper_N;
  }
  std::printf("certified up to %.1f N\n", certified_up_to_N);
  return report.certified && certified_up_to_N > 4.5 ? 0 : 1;
}
