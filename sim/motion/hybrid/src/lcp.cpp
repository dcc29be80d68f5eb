#include "breakaway/hybrid/lcp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace breakaway::hybrid {
namespace {

// Plain loops over a table that is no larger than it must be: the problems are small, and met at every event.
template <class Scalar>
class Lemke {
 public:
  Lemke(const LcpMatrix<Scalar>& a, const LcpVector<Scalar>& b)
      : size_{static_cast<int>(b.size())}, width_{2 * size_ + 2} {
    // w - A z - z0 = b; columns: w, z, z0, b.
    for (int row = 0; row < size_; ++row) {
      Scalar* const entries = row_of(row);
      std::fill_n(entries, size_, Scalar{0});
      entries[row] = 1;
      for (int column = 0; column < size_; ++column) entries[size_ + column] = -a(row, column);
      entries[artificial()] = -1;
      entries[right()] = b[row];
      basis_[static_cast<std::size_t>(row)] = row;
    }
  }

  std::optional<LcpSolution<Scalar>> solve() {
    int row = 0;
    for (int other = 1; other < size_; ++other) {
      if (entry(other, right()) < entry(row, right())) row = other;
    }
    if (size_ == 0 || entry(row, right()) >= 0) return solution();
    int entering = artificial();
    for (int pivots = 0; pivots < 64 * (size_ + 1); ++pivots) {
      const int leaving = pivot(row, entering);
      if (leaving == artificial()) return solution();
      entering = leaving < size_ ? leaving + size_ : leaving - size_;
      row = ratio_test(entering);
      if (row < 0) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  int artificial() const { return 2 * size_; }
  int right() const { return 2 * size_ + 1; }

  Scalar* row_of(int row) { return table_.data() + std::ptrdiff_t{row} * width_; }
  Scalar entry(int row, int column) const { return *(table_.data() + std::ptrdiff_t{row} * width_ + column); }
  int& basis(int row) { return basis_[static_cast<std::size_t>(row)]; }

  int pivot(int row, int entering) {
    Scalar* const pivots = row_of(row);
    const Scalar by = pivots[entering];
    for (int column = 0; column < width_; ++column) pivots[column] /= by;
    pivots[entering] = 1;
    for (int other = 0; other < size_; ++other) {
      Scalar* const entries = row_of(other);
      const Scalar factor = entries[entering];
      if (other == row || factor == 0) continue;
      for (int column = 0; column < width_; ++column) entries[column] -= factor * pivots[column];
    }
    return std::exchange(basis(row), entering);
  }

  // The row whose variable reaches zero first, -1 for none. Among equals that of the artificial variable, which ends
  // the search, else the largest pivot, which keeps rounding small.
  int ratio_test(int entering) {
    int best = -1;
    Scalar best_ratio = std::numeric_limits<Scalar>::infinity(), greatest = 0;
    for (int row = 0; row < size_; ++row) greatest = std::max(greatest, std::abs(entry(row, entering)));
    for (int row = 0; row < size_; ++row) {
      if (!(entry(row, entering) > rounding * greatest)) continue;
      const Scalar ratio = entry(row, right()) / entry(row, entering);
      const bool equal = best >= 0 && std::abs(ratio - best_ratio) <= rounding * std::abs(best_ratio);
      const bool preferred = basis(row) == artificial() ||
                             (best >= 0 && basis(best) != artificial() && entry(row, entering) > entry(best, entering));
      if (best < 0 || (equal ? preferred : ratio < best_ratio)) {
        best = row;
        best_ratio = ratio;
      }
    }
    return best;
  }

  LcpSolution<Scalar> solution() {
    LcpSolution<Scalar> solution{LcpVector<Scalar>::Zero(size_), 0};
    for (int row = 0; row < size_; ++row) {
      const int variable = basis(row) - size_;
      if (variable < 0 || variable >= size_) continue;
      solution.z[variable] = entry(row, right());
      solution.basic |= std::uint32_t{1} << variable;
    }
    return solution;
  }

  // What is below this share of its terms may be zero.
  static constexpr Scalar rounding = 450 * std::numeric_limits<Scalar>::epsilon();

  int size_, width_;
  std::array<Scalar, std::size_t{most_unknowns} * (2 * std::size_t{most_unknowns} + 2)>
      table_;  // row by row, `width_` each
  std::array<int, most_unknowns> basis_;
};

}  // namespace

template <class Scalar>
std::optional<LcpSolution<Scalar>> solve_lcp(const LcpMatrix<Scalar>& a, const LcpVector<Scalar>& b) {
  return Lemke<Scalar>(a, b).solve();
}

template std::optional<LcpSolution<double>> solve_lcp(const LcpMatrix<double>&, const LcpVector<double>&);
template std::optional<LcpSolution<long double>> solve_lcp(const LcpMatrix<long double>&,
                                                           const LcpVector<long double>&);

}  // namespace breakaway::hybrid
