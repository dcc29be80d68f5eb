// The linear complementarity problem w = A z + b, w >= 0, z >= 0, w^T z = 0, by Lemke's method. It ends with the
// solution for every A that is copositive-plus, which those of dry friction are (Cottle, Pang & Stone, The Linear
// Complementarity Problem, theorem 4.4.12). There is no absolute tolerance.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace breakaway::hybrid {

// At most Size unknowns; Eigen::Dynamic allocates.
template <int Size>
using LcpMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, Size, Size>;
template <int Size>
using LcpVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, Size, 1>;

template <int Size>
class Lemke {
 public:
  Lemke(const LcpMatrix<Size>& a, const LcpVector<Size>& b) : size_{b.size()}, table_(size_, 2 * size_ + 2) {
    // w - A z - z0 = b; columns: w, z, z0, b.
    table_.setZero();
    table_.leftCols(size_).setIdentity();
    table_.middleCols(size_, size_) = -a;
    table_.col(artificial()).setConstant(-1);
    table_.col(right()) = b;
    basis_.resize(size_);
    for (Eigen::Index row = 0; row < size_; ++row) basis_[row] = row;
  }

  // z; nothing if the problem has no solution.
  std::optional<LcpVector<Size>> solve() {
    if (size_ == 0) return solution();
    Eigen::Index row = 0;
    if (table_.col(right()).minCoeff(&row) >= 0) return solution();
    Eigen::Index entering = artificial();
    for (Eigen::Index pivots = 0; pivots < 64 * (size_ + 1); ++pivots) {
      const Eigen::Index leaving = pivot(row, entering);
      if (leaving == artificial()) return solution();
      entering = leaving < size_ ? leaving + size_ : leaving - size_;
      const auto next = ratio_test(entering);
      if (!next) return {};
      row = *next;
    }
    return {};
  }

 private:
  static constexpr int columns = Size == Eigen::Dynamic ? Eigen::Dynamic : 2 * Size + 2;

  Eigen::Index artificial() const { return 2 * size_; }
  Eigen::Index right() const { return 2 * size_ + 1; }

  Eigen::Index pivot(Eigen::Index row, Eigen::Index entering) {
    table_.row(row) /= table_(row, entering);
    table_(row, entering) = 1;
    for (Eigen::Index other = 0; other < size_; ++other) {
      const double factor = table_(other, entering);
      if (other != row && factor != 0) table_.row(other) -= factor * table_.row(row);
    }
    return std::exchange(basis_[row], entering);
  }

  // The row whose variable reaches zero first. Among equals that of the artificial variable, which ends the search,
  // else the largest pivot, which keeps rounding small.
  std::optional<Eigen::Index> ratio_test(Eigen::Index entering) const {
    std::optional<Eigen::Index> best;
    double best_ratio = std::numeric_limits<double>::infinity();
    const double rounding = 1e-13 * table_.col(entering).cwiseAbs().maxCoeff();
    for (Eigen::Index row = 0; row < size_; ++row) {
      if (!(table_(row, entering) > rounding)) continue;
      const double ratio = table_(row, right()) / table_(row, entering);
      const bool equal = best && std::abs(ratio - best_ratio) <= 1e-13 * std::abs(best_ratio);
      const bool preferred = basis_[row] == artificial() ||
                             (best && basis_[*best] != artificial() && table_(row, entering) > table_(*best, entering));
      if (!best || (equal ? preferred : ratio < best_ratio)) {
        best = row;
        best_ratio = ratio;
      }
    }
    return best;
  }

  LcpVector<Size> solution() const {
    LcpVector<Size> z = LcpVector<Size>::Zero(size_);
    for (Eigen::Index row = 0; row < size_; ++row) {
      if (basis_[row] >= size_ && basis_[row] < artificial()) z[basis_[row] - size_] = table_(row, right());
    }
    return z;
  }

  Eigen::Index size_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, Size, columns> table_;
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1, Eigen::ColMajor, Size, 1> basis_;
};

template <int Size>
std::optional<LcpVector<Size>> solve_lcp(const LcpMatrix<Size>& a, const LcpVector<Size>& b) {
  return Lemke<Size>(a, b).solve();
}

}  // namespace breakaway::hybrid
