// The states that the points of a grid stand for.
#pragma once

#include <Eigen/Core>

#include "breakaway/hybrid/types.hpp"
#include "breakaway/study/basin.hpp"

namespace breakaway::study {

template <int N>
class GridStarts {
 public:
  // `centre`: K^-1 f, from which q is counted.
  GridStarts(const Grid& grid, const Eigen::VectorXd& centre)
      : grid_{grid}, centre_{centre}, zero_{Eigen::Matrix<double, N, 1>::Zero(centre.size())} {}

  hybrid::MachineState<N> at(int column, int row) const {
    hybrid::MachineState<N> start{0, centre_, zero_};
    add(start, grid_.plane[0], grid_.coordinate(column));
    add(start, grid_.plane[1], grid_.coordinate(row));
    return start;
  }

 private:
  void add(hybrid::MachineState<N>& state, int place, double value) const {
    const Eigen::Index n = centre_.size();
    (place < n ? state.q[place] : state.v[place - n]) += value;
  }

  Grid grid_;
  Eigen::Matrix<double, N, 1> centre_, zero_;
};

}  // namespace breakaway::study
