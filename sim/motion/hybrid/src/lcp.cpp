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
class Lemke {
 public:
  Lemke(const LcpMatrix& a, const LcpVector& b) : size_{static_cast<int>(b.size())}, width_{2 * size_ + 2} {
    // w - A z - z0 = b; columns: w, z, z0, b.
    for (int row = 0; row < size_; ++row) {
      double* const entries = row_of(row);
      std::fill_n(entries, size_, 0.0);
      entries[row] = 1;
      for (int column = 0; column < size_; ++column) entries[size_ + column] = -a(row, column);
      entries[artificial()] = -1;
      entries[right()] = b[row];
      basis_[static_cast<std::size_t>(row)] = row;
    }
  }

  std::optional<LcpVector> solve() {
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

  double* row_of(int row) { return table_.data() + std::ptrdiff_t{row} * width_; }
  double entry(int row, int column) const { return *(table_.data() + std::ptrdiff_t{row} * width_ + column); }
  int& basis(int row) { return basis_[static_cast<std::size_t>(row)]; }

  int pivot(int row, int entering) {
    double* const pivots = row_of(row);
    const double by = pivots[entering];
    for (int column = 0; column < width_; ++column) pivots[column] /= by;
    pivots[entering] = 1;
    for (int other = 0; other < size_; ++other) {
      double* const entries = row_of(other);
      const double factor = entries[entering];
      if (other == row || factor == 0) continue;
      for (int column = 0; column < width_; ++column) entries[column] -= factor * pivots[column];
    }
    return std::exchange(basis(row), entering);
  }

  // The row whose variable reaches zero first, -1 for none. Among equals that of the artificial variable, which ends
  // the search, else the largest pivot, which keeps rounding small.
  int ratio_test(int entering) {
    int best = -1;
    double best_ratio = std::numeric_limits<double>::infinity(), greatest = 0;
    for (int row = 0; row < size_; ++row) greatest = std::max(greatest, std::abs(entry(row, entering)));
    for (int row = 0; row < size_; ++row) {
      if (!(entry(row, entering) > 1e-13 * greatest)) continue;
      const double ratio = entry(row, right()) / entry(row, entering);
      const bool equal = best >= 0 && std::abs(ratio - best_ratio) <= 1e-13 * std::abs(best_ratio);
      const bool preferred = basis(row) == artificial() ||
                             (best >= 0 && basis(best) != artificial() && entry(row, entering) > entry(best, entering));
      if (best < 0 || (equal ? preferred : ratio < best_ratio)) {
        best = row;
        best_ratio = ratio;
      }
    }
    return best;
  }

  LcpVector solution() {
    LcpVector z = LcpVector::Zero(size_);
    for (int row = 0; row < size_; ++row) {
      if (basis(row) >= size_ && basis(row) < artificial()) z[basis(row) - size_] = entry(row, right());
    }
    return z;
  }

  int size_, width_;
  std::array<double, std::size_t{most_unknowns} * (2 * std::size_t{most_unknowns} + 2)>
      table_;  // row by row, `width_` each
  std::array<int, most_unknowns> basis_;
};

}  // namespace

std::optional<LcpVector> solve_lcp(const LcpMatrix& a, const LcpVector& b) { return Lemke(a, b).solve(); }

}  // namespace breakaway::hybrid
