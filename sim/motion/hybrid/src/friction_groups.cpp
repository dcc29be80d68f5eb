#include "breakaway/hybrid/friction_groups.hpp"

#include <cmath>
#include <utility>

#include "breakaway/stability/extended.hpp"

namespace breakaway::hybrid {
namespace {

using Eigen::Index;

// The directions as unit vectors in coordinates in which the mass is the identity; zero for a direction that moves
// nothing.
stability::extended::Matrix unit_directions(const LinearMachine<>& machine) {
  stability::extended::Matrix units = stability::extended::inverse_cholesky_factor(machine.mass.cast<long double>()) *
                                      machine.directions.cast<long double>();
  for (Index i = 0; i < units.cols(); ++i) units.col(i).stableNormalize();
  return units;
}

bool parallel(const stability::extended::Vector& one, const stability::extended::Vector& other) {
  return (one - std::copysign(1.0L, one.dot(other)) * other).norm() <= parallel_angle;
}

// c of other = c one.
double multiple_of(const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
  Index largest = 0;
  one.cwiseAbs().maxCoeff(&largest);
  return other[largest] / one[largest];
}

}  // namespace

FrictionGroups group_frictions(LinearMachine<> machine) {
  const auto units = unit_directions(machine);
  const auto count = static_cast<std::size_t>(machine.frictions());
  FrictionGroups groups{std::vector<int>(count, -1), std::vector<double>(count, 0), {}};
  for (Index i = 0; i < machine.frictions(); ++i) {
    int& own = groups.leader[static_cast<std::size_t>(i)];
    double& multiple = groups.multiple[static_cast<std::size_t>(i)];
    if (machine.friction_N[i] > 0 && units.col(i).squaredNorm() > 0) {
      own = static_cast<int>(i);
      multiple = 1;
    }
    for (Index j = 0; own == i && j < i; ++j) {
      if (groups.leader[static_cast<std::size_t>(j)] != j || !parallel(units.col(j), units.col(i))) continue;
      own = static_cast<int>(j);
      multiple = multiple_of(machine.directions.col(j), machine.directions.col(i));
      machine.friction_N[j] += std::abs(multiple) * machine.friction_N[i];
    }
    if (own == i) continue;
    machine.directions.col(i).setZero();
    machine.friction_N[i] = 0;
  }
  groups.machine = std::move(machine);
  return groups;
}

}  // namespace breakaway::hybrid
