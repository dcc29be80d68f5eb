#include "breakaway/study/resting_batch.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "breakaway/hybrid/refused.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/run_machine.hpp"

namespace breakaway::study {
namespace {

using Eigen::VectorXd;

// Uniform in the unit ball. By Box and Muller's method: the standard library's own normal numbers differ between
// implementations.
VectorXd in_unit_ball(std::mt19937_64& random, Eigen::Index size) {
  const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  VectorXd point(size);
  for (double& entry : point) {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    entry = radius * std::cos(2 * std::numbers::pi * uniform());
  }
  return point.normalized() * std::pow(uniform(), 1 / static_cast<double>(size));
}

// A motion from the border of a level loses its energy slowly, but it does lose it.
constexpr double on_its_way = 0.999;

void follow(const scenario::MachineScenario& s, RestingBatch& batch) try {
  const sil::MachineResult result = sil::run_machine(s);
  if (result.settled()) {
    ++batch.at_rest;
  } else if (energy_J(s.machine, result.outcome.end) < on_its_way * energy_J(s.machine, *s.start)) {
    ++batch.on_their_way;
  } else if (!batch.not_at_rest) {
    batch.not_at_rest = s.start;
  }
} catch (const hybrid::Refused&) {
  ++batch.refused;
}

}  // namespace

RestingBatch run_to_rest(scenario::MachineScenario s, double level_J, double duration_s, int trajectories,
                         std::uint64_t seed, const std::function<void(double share)>& progress) {
  const Eigen::Index n = s.machine.coordinates();
  const Eigen::LLT<Eigen::MatrixXd> stiffness(s.machine.stiffness), mass(s.machine.mass);
  std::mt19937_64 random{seed};
  const std::string file = std::exchange(s.file, "");  // a refusal is told by its type
  s.impulses.clear();
  s.duration_s = duration_s;
  RestingBatch batch;
  try {
    for (; batch.trajectories < trajectories; ++batch.trajectories) {
      if (progress) progress(static_cast<double>(batch.trajectories) / trajectories);
      const VectorXd x = std::sqrt(2 * level_J) * in_unit_ball(random, 2 * n);
      s.start = {0, stiffness.matrixU().solve(x.head(n)), mass.matrixU().solve(x.tail(n))};
      follow(s, batch);
    }
  } catch (const InputError& error) {
    throw error.in_file(file);
  }
  return batch;
}

}  // namespace breakaway::study
