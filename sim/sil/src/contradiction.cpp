#include "breakaway/sil/contradiction.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace breakaway::sil {
namespace {

using State = hybrid::MachineState<Eigen::Dynamic>;

constexpr double tolerance = 1e-6;  // relative

// The largest |z| over { V <= 1/2 }, z being the linear function of an escape level.
double steepness(const stability::LinearMachine<>& machine, const stability::EscapeLevel& escape) {
  const Eigen::Index n = machine.coordinates();
  const Eigen::LLT<Eigen::MatrixXd> stiffness(machine.stiffness), mass(machine.mass);
  Eigen::MatrixXd both(2 * n, 2);
  both << escape.real, escape.imaginary;
  both.topRows(n) = stiffness.matrixL().solve(both.topRows(n)).eval();
  both.bottomRows(n) = mass.matrixL().solve(both.bottomRows(n)).eval();
  const Eigen::Matrix2d gram = both.transpose() * both;
  const double mean = gram.trace() / 2;
  return std::sqrt(mean + std::hypot((gram(0, 0) - gram(1, 1)) / 2, gram(0, 1)));
}

State about(const Eigen::VectorXd& centre, State state) {
  state.q -= centre;
  return state;
}

}  // namespace

Contradiction::Contradiction(const std::string& facts)
    : InputError{"contradiction: " + facts +
                 "; one of the two is wrong, so neither is to be trusted: try another method or other units, and "
                 "report this machine"} {}

void require_consistent(const stability::LinearMachine<>& machine, const Certificates& certificates) {
  const double level_J = certificates.attractivity.level_J;
  if (!(level_J > 0)) return;
  for (const stability::EscapeLevel& escape : certificates.escapes) {
    const double farthest = std::sqrt(2 * level_J) * steepness(machine, escape);
    if (!(farthest > escape.level * (1 + tolerance))) continue;
    throw Contradiction{fmt::format(
        "the machine is certified to come to rest from below {:.6g} J, and from some of these states to grow for ever, "
        "at {:.6g} 1/s",
        level_J, escape.growth_rate)};
  }
}

void require_consistent(const stability::LinearMachine<>& machine, const Certificates& certificates, const State& from,
                        const hybrid::Outcome<Eigen::Dynamic>& outcome) {
  const hybrid::Verdict proved = ProvenFate<Eigen::Dynamic>{machine, certificates}(from);
  const double lasted_s = outcome.end.time_s - from.time_s;
  if (proved == hybrid::Verdict::lost && outcome.verdict == hybrid::Verdict::at_rest) {
    throw Contradiction{
        fmt::format("the motion is certified never to come to rest, and was at rest after {:.6g} s", lasted_s)};
  }
  if (proved != hybrid::Verdict::captured) return;
  if (outcome.verdict == hybrid::Verdict::lost) {
    throw Contradiction{fmt::format(
        "the motion is certified to come to rest, and was found to grow for ever after {:.6g} s", lasted_s)};
  }
  const double before_J = stability::energy_J(machine, about(certificates.centre, from));
  const double after_J = stability::energy_J(machine, about(certificates.centre, outcome.end));
  // What is not a number contradicts, too.
  if (after_J <= before_J * (1 + tolerance)) return;
  throw Contradiction{
      fmt::format("the motion is certified to come to rest, and its energy grew from {:.6g} J to {:.6g} J in {:.6g} s",
                  before_J, after_J, lasted_s)};
}

}  // namespace breakaway::sil
