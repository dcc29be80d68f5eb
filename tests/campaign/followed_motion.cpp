#include "followed_motion.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/stability/mass_units.hpp"

namespace breakaway::campaign {
namespace {

using Eigen::VectorXd;
using stability::LinearMachine;
using State = hybrid::MachineState<Eigen::Dynamic>;

// V and what its rounding may be: positions and springs may cancel.
struct Energy {
  double J, rounding_J;
};

Energy energy(const LinearMachine<>& machine, const State& state) {
  const VectorXd q = state.q.cwiseAbs(), v = state.v.cwiseAbs();
  const double terms_J = q.dot(machine.stiffness.cwiseAbs() * q) + v.dot(machine.mass.cwiseAbs() * v);
  return {stability::energy_J(machine, state), 1e-13 * terms_J};
}

class Exhausted {};

}  // namespace

End followed(const LinearMachine<>& machine, const stability::Attractivity& a, WildMachines& random, std::string& said,
             int most_events) {
  State start{0, random.anywhere(machine.coordinates()), random.anywhere(machine.coordinates())};
  const VectorXd unit = stability::mass_units(machine.mass);
  start.q = unit.cwiseProduct(start.q);
  start.v = unit.cwiseProduct(start.v);
  const double rest_J = a.greatest_rest_J > 0 ? a.greatest_rest_J : 1;
  const double wanted_J = std::min(0.9 * a.level_J, 1e6 * rest_J);
  const double scale = std::sqrt(wanted_J / stability::energy_J(machine, start));
  start.q *= scale;
  start.v *= scale;
  Energy before = energy(machine, start);
  int events = 0;
  bool grew = false;
  const hybrid::EventDriven<> integrator{machine, [&](const State& state) {
                                           const Energy now = energy(machine, state);
                                           if (!(now.J <= before.J * (1 + 1e-7) + now.rounding_J + before.rounding_J)) {
                                             grew = true;
                                             said = "V grew from " + std::to_string(std::log10(before.J)) + " to " +
                                                    std::to_string(std::log10(now.J)) + " (log10 J) at event " +
                                                    std::to_string(events);
                                             throw Exhausted{};
                                           }
                                           before = now;
                                           if (++events > most_events) throw Exhausted{};
                                           return hybrid::Verdict::undecided;
                                         }};
  const double slowest = std::sqrt(stability::definiteness(machine.stiffness));
  try {
    const auto outcome = integrator.run(start, 1e5 / std::max(slowest, 1e-3));
    const Energy after = energy(machine, outcome.end);
    if (!(after.J <= before.J * (1 + 1e-7) + after.rounding_J + before.rounding_J)) {
      said = "V grew in the end, from " + std::to_string(before.J) + " J to " + std::to_string(after.J) + " J";
      return End::grew;
    }
    if (outcome.verdict == hybrid::Verdict::lost) {
      said = "it is lost";
      return End::grew;
    }
    return outcome.verdict == hybrid::Verdict::undecided ? End::on_its_way : End::at_rest;
  } catch (const Exhausted&) {
    return grew ? End::grew : End::on_its_way;
  } catch (const InputError& refusal) {
    said = refusal.what();
    return End::refused;
  }
}

}  // namespace breakaway::campaign
