#include "breakaway/hybrid/mode_choice.hpp"

#include "breakaway/hybrid/refused.hpp"

namespace breakaway::hybrid {

namespace twofold = stability::twofold;

ModeChoice::ModeChoice(const LinearMachine<>& machine)
    : damping_{machine.damping.cast<Extended>()}, stiffness_{machine.stiffness.cast<Extended>()} {
  const ExtendedMatrix inverse_factor = twofold::inverse_cholesky_factor(machine.mass.cast<Extended>());
  const ExtendedMatrix directions = inverse_factor * machine.directions.cast<Extended>();
  response_ = directions.transpose() * inverse_factor;
  coupling_ = directions.transpose() * directions;
  rounded_response_ = response_.cast<double>();
  rounded_coupling_ = coupling_.cast<double>();
}

Sliding ModeChoice::sliding(const Stop& stop) const {
  const ExtendedVector force = balance(stop.applied, stop.q, stop.v);
  const auto count = static_cast<Eigen::Index>(stop.stopped.size());
  StopProblem<long double> problem(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Index i = stop.stopped[static_cast<std::size_t>(r)];
    problem.acceleration[r] = static_cast<long double>(response_.row(i).dot(force));
    problem.rounding[r] = static_cast<long double>(response_.row(i).cwiseAbs().dot(stop.rounding.cast<Extended>()));
    problem.forward_N[r] = stop.forward_N[r];
    problem.backward_N[r] = stop.backward_N[r];
    for (Eigen::Index c = 0; c < count; ++c) {
      problem.coupling(r, c) = static_cast<long double>(coupling_(i, stop.stopped[static_cast<std::size_t>(c)]));
    }
  }
  if (const auto decision = sliding_after_stop(problem)) return *decision;
  // The springs' forces are those of a state that is rounded itself. Where they outweigh friction, what is right for
  // the very state is as good as any decision can be: another one belongs to a state that differs in its last digit.
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Index i = stop.stopped[static_cast<std::size_t>(r)];
    problem.rounding[r] =
        static_cast<long double>(response_.row(i).cwiseAbs().dot(stop.applied_rounding.cast<Extended>()));
  }
  if (const auto decision = sliding_after_stop(problem)) return *decision;
  refuse(stop.time_s);
}

void ModeChoice::refuse(double time_s) {
  throw Refused{"which friction directions stick at t = " + shown(time_s) +
                    " s cannot be decided in double precision, because friction, masses or nearly parallel directions "
                    "differ too much in size",
                "leave out the least friction", "set [run] integrator to \"time_stepping\""};
}

}  // namespace breakaway::hybrid
