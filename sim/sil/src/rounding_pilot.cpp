#include "rounding_pilot.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace breakaway::sil {
namespace {

using scenario::MachineScenario;

// How many of the new units make one of the old. None is a power of two, which would round alike.
struct Units {
  double length, time, force;
};
constexpr std::array pilots{Units{1.1, 1.3, 0.7}, Units{0.6, 1.7, 1.9}, Units{1.45, 0.55, 1.15}};

// Requires constant friction: a law has lengths and times of its own.
MachineScenario in_units(MachineScenario s, const Units& u) {
  s.machine.force_N = stability::constant_force(s.machine) * u.force;
  s.machine.friction_N *= u.force;
  s.machine.stiffness *= u.force / u.length;
  s.machine.damping *= u.force * u.time / u.length;
  s.machine.mass *= u.force * u.time * u.time / u.length;
  s.start->q *= u.length;
  s.start->v *= u.length / u.time;
  s.duration_s *= u.time;
  for (scenario::MachineImpulse& impulse : s.impulses) {
    impulse.time_s *= u.time;
    impulse.impulse_Ns *= u.force * u.time;
  }
  return s;
}

}  // namespace

double rounding_error_m(const MachineScenario& scenario, const MachineEnd& end) {
  double scatter_m = 0;
  for (const Units& units : pilots) {
    MachineEnd pilot = machine_end(in_units(scenario, units), {scenario::Integrator::event_driven});
    pilot.q_m /= units.length;
    scatter_m = std::max(scatter_m, pilot.distance_m(end));
  }
  // All ends may agree to the last digit of what they are sums of.
  const double size_m = std::max(end.q_m.cwiseAbs().maxCoeff(), scenario.start->q.cwiseAbs().maxCoeff());
  const double last_digit_m = 4 * std::numeric_limits<double>::epsilon() * size_m;
  return 2 * scatter_m + last_digit_m;
}

}  // namespace breakaway::sil
