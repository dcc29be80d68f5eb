// Example 4: hold the controller to its promise under a friction law of your own.
//
// A shape says where between its two bounds the friction is, as a number from 0 to 1. The shape below is a guide with a
// bad spot: friction is at its upper bound there and falls off smoothly to both sides. The controller reaches its
// target under every law between the bounds, so it must do so wherever the spot is.
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>

#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"

using namespace breakaway;

class BadSpot final : public model::Shape {
 public:
  explicit BadSpot(double place_m) : place_m_{place_m} {}

  std::unique_ptr<Shape> clone() const override { return std::make_unique<BadSpot>(*this); }

  double value(double /*time_s*/, double position_m, double /*speed_m_s*/) const override {
    constexpr double width_m = 2e-3;
    const double widths = (position_m - place_m_) / width_m;
    return 1 / (1 + widths * widths);
  }

  // Friction changes while the axis moves, so the simulation has to integrate instead of taking a closed form.
  bool varies_with_motion() const override { return true; }

 private:
  double place_m_;
};

int main() try {
  scenario::Scenario scenario = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  const model::FrictionBounds bounds = scenario.worlds[0].friction.bounds();  // the true ones, where [told] has others
  const double promised_m = config::judged_tolerance_m(scenario.node, scenario.node.axes[0]);
  bool kept = true;
  for (const double place_m : {-0.1, -0.0005, 0.0, 0.0005, 0.1}) {  // the target is at 0
    scenario.worlds[0].friction = {bounds, std::make_unique<BadSpot>(place_m)};
    const sil::Result result = sil::run_scenario(scenario, {});
    const sil::AxisResult& axis = result.axes[0];
    std::printf("bad spot at %7.1f mm: %s after %.3f s and %2zu kicks, %5.2f um from the target\n", 1e3 * place_m,
                axis.settled ? "settled" : "NOT settled", axis.settling_time_s, axis.kicks.size(),
                1e6 * axis.final_error_m);
    kept = kept && axis.settled && std::abs(axis.final_error_m) <= promised_m;
  }
  std::printf("the promise of %.1f um was %s\n", 1e6 * promised_m, kept ? "kept" : "NOT kept");
  return kept ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
