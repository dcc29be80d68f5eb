#include "breakaway/hybrid/lcp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace breakaway::hybrid {
namespace {

// Plain loops over a table that is no larger than it must be, with columns for the variables that are not basic: the
// problems are small, and met at every event.
template <class Scalar>
class Lemke {
 public:
  Lemke(const LcpMatrix<Scalar>& a, const LcpVector<Scalar>& b) : size_{static_cast<int>(b.size())}, width_{size_ + 2} {
    // w - A z - z0 = b; rows: w; columns: z, z0, b. Variables are numbered w, z, z0.
    for (int row = 0; row < size_; ++row) {
      Scalar* const entries = row_of(row);
      for (int column = 0; column < size_; ++column) entries[column] = -a(row, column);
      entries[size_] = -1;
      entries[right()] = b[row];
      basis(row) = row;
    }
    for (int column = 0; column <= size_; ++column) free(column) = size_ + column;
  }

  std::optional<LcpSolution<Scalar>> solve() {
    int row = 0;
    for (int other = 1; other < size_; ++other) {
      if (entry(other, right()) < entry(row, right())) row = other;
    }
    if (size_ == 0 || entry(row, right()) >= 0) return solution();
    int entering = size_;
    for (int pivots = 0; pivots < 64 * (size_ + 1); ++pivots) {
      const int leaving = pivot(row, entering);
      if (leaving == artificial()) return solution();
      entering = column_of(leaving < size_ ? leaving + size_ : leaving - size_);
      row = ratio_test(entering);
      if (row < 0) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  int artificial() const { return 2 * size_; }
  int right() const { return size_ + 1; }

  Scalar* row_of(int row) { return table_.data() + std::ptrdiff_t{row} * width_; }
  Scalar entry(int row, int column) const { return *(table_.data() + std::ptrdiff_t{row} * width_ + column); }
  int& basis(int row) { return basis_[static_cast<std::size_t>(row)]; }
  int& free(int column) { return free_[static_cast<std::size_t>(column)]; }
  int column_of(int variable) {
    int column = 0;
    while (free(column) != variable) ++column;
    return column;
  }

  // Exchanges the row's variable, which is returned, for that of the column.
  int pivot(int row, int entering) {
    Scalar* const pivots = row_of(row);
    const Scalar by = std::exchange(pivots[entering], Scalar{1});
    for (int column = 0; column < width_; ++column) pivots[column] /= by;
    for (int other = 0; other < size_; ++other) {
      Scalar* const entries = row_of(other);
      if (other == row || entries[entering] == 0) continue;
      const Scalar factor = std::exchange(entries[entering], Scalar{0});
      for (int column = 0; column < width_; ++column) entries[column] -= factor * pivots[column];
    }
    std::swap(basis(row), free(entering));
    return free(entering);
  }

  // Of two rows whose variables reach zero together that of the artificial variable, which ends the search, else that
  // of the larger pivot, which keeps rounding small.
  bool preferred(int row, int best, int entering) {
    return basis(row) == artificial() || (basis(best) != artificial() && entry(row, entering) > entry(best, entering));
  }

  // The row whose variable reaches zero first, -1 for none.
  int ratio_test(int entering) {
    int best = -1;
    Scalar best_ratio = std::numeric_limits<Scalar>::infinity(), greatest = 0;
    for (int row = 0; row < size_; ++row) greatest = std::max(greatest, std::abs(entry(row, entering)));
    for (int row = 0; row < size_; ++row) {
      if (!(entry(row, entering) > rounding * greatest)) continue;
      const Scalar ratio = entry(row, right()) / entry(row, entering);
      const bool equal = best >= 0 && std::abs(ratio - best_ratio) <= rounding * std::abs(best_ratio);
      if (best < 0 || (equal ? preferred(row, best, entering) : ratio < best_ratio)) {
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
  // Row by row, `width_` each.
  std::array<Scalar, std::size_t{most_unknowns} * (std::size_t{most_unknowns} + 2)> table_;
  std::array<int, most_unknowns> basis_;     // by row
  std::array<int, most_unknowns + 1> free_;  // by column
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
