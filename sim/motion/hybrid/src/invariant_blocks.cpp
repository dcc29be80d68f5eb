#include "breakaway/hybrid/invariant_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace breakaway::hybrid {
namespace {

namespace twofold = stability::twofold;
using Eigen::Index;
using twofold::Matrix;
using Scalar = twofold::Scalar;

// Coordinates told apart at this factor cost as much of double's 16 digits.
constexpr double most_coupling = 300;
// More where a block that stays together is as ill-conditioned itself.
constexpr double most_coupling_of_ill_conditioned = 1e5;
// Time scales further apart than this are cut first, each to be scaled by itself.
constexpr double scale_gap = 8;
constexpr double most_scale_coupling = 1e6;
// Free motion has no time of its own: the double eigenvalue zero is off by the root of extended precision's rounding.
constexpr double no_time_scale = 1e-14;

double largest_entry(const Matrix& matrix) { return matrix.size() == 0 ? 0 : double(matrix.cwiseAbs().maxCoeff()); }

Index block_size(const Matrix& form, Index at) { return at + 1 < form.rows() && form(at + 1, at) != 0 ? 2 : 1; }

// The size of the block's eigenvalues.
double magnitude(const Matrix& form, Index at) {
  if (block_size(form, at) == 1) return std::abs(double(form(at, at)));
  const Scalar determinant = form(at, at) * form(at + 1, at + 1) - form(at, at + 1) * form(at + 1, at);
  return std::sqrt(std::abs(double(determinant)));
}

// The real part and the imaginary one.
std::pair<double, double> eigenvalue(const Matrix& form, Index at) {
  if (block_size(form, at) == 1) return {double(form(at, at)), 0};
  const Scalar half = (form(at, at) - form(at + 1, at + 1)) / 2;
  const double square = double(half * half + form(at, at + 1) * form(at + 1, at));
  return {double((form(at, at) + form(at + 1, at + 1)) / 2), std::sqrt(std::max(0.0, -square))};
}

// (A, B) as one matrix on the entries of X, column by column: A X - X B.
Matrix kronecker(const Matrix& a, const Matrix& b) {
  const Index p = a.rows(), q = b.rows();
  Matrix matrix = Matrix::Zero(p * q, p * q);
  for (Index column = 0; column < q; ++column) {
    matrix.block(p * column, p * column, p, p) = a;
    for (Index other = 0; other < q; ++other) {
      for (Index row = 0; row < p; ++row) matrix(p * column + row, p * other + row) -= b(other, column);
    }
  }
  return matrix;
}

// Powers of two that bring each row's size near its column's (Parlett & Reinsch): A -> D^-1 A D.
Matrix balance(Matrix& a) {
  const Index n = a.rows();
  Matrix scales = Matrix::Ones(n, 1);
  bool changed = true;
  for (int sweep = 0; changed && sweep < 100; ++sweep) {
    changed = false;
    for (Index i = 0; i < n; ++i) {
      double row = 0, column = 0;
      for (Index j = 0; j < n; ++j) {
        if (j == i) continue;
        row = std::max(row, std::abs(double(a(i, j))));
        column = std::max(column, std::abs(double(a(j, i))));
      }
      if (row == 0 || column == 0) continue;
      const int shift = static_cast<int>(std::round((std::log2(row) - std::log2(column)) / 2));
      if (shift == 0) continue;
      const Scalar scale = std::ldexp(1.0, shift), inverse = std::ldexp(1.0, -shift);
      a.row(i) *= inverse;
      a.col(i) *= scale;
      scales(i) *= scale;
      changed = true;
    }
  }
  return scales;
}

// The ordered Schur form of A in the making: A basis = basis form.
struct Ordered {
  Matrix form, basis;

  Index size() const { return form.rows(); }

  // Moves the block that begins at `from` up to `to`. Returns where it came to stand.
  Index raise(Index from, Index to) {
    while (from > to) {
      const Index size = block_size(form, from);
      const Index before = from >= to + 2 && block_size(form, from - 2) == 2 ? 2 : 1;
      if (!exchange(form, basis, from - before, before, size)) return from;
      from -= before;
    }
    return from;
  }

  // Takes what couples the first rows of a part to the rest out of it, unless that takes more than `most`.
  bool decouple(Index first, Index size, double most) {
    const Index rest = this->size() - first - size;
    const Matrix own = form.block(first, first, size, size), others = form.bottomRightCorner(rest, rest);
    const Matrix shared = form.block(first, first + size, size, rest);
    const Matrix coupling = sylvester(own, others, -shared);
    if (!(largest_entry(coupling) <= most)) return false;
    // Equal eigenvalues leave the equations without a solution, and their rounding with one.
    if (!(largest_entry(own * coupling - coupling * others + shared) <=
          1e-24 * (largest_entry(own) + largest_entry(shared)))) {
      return false;
    }
    basis.rightCols(rest) += (basis.middleCols(first, size) * coupling).eval();
    form.block(first, first + size, size, rest).setZero();
    return true;
  }
};

// The fastest first.
void order_by_magnitude(Ordered& ordered) {
  for (Index at = 0; at < ordered.size(); at += block_size(ordered.form, at)) {
    const double here = magnitude(ordered.form, at);
    Index to = 0;
    while (to < at && magnitude(ordered.form, to) * 2 >= here) to += block_size(ordered.form, to);
    if (to < at) ordered.raise(at, to);
  }
}

// Where the time scales may be cut: the first index behind each.
std::vector<Index> gaps(const Matrix& form) {
  std::vector<Index> starts, result;
  for (Index at = 0; at < form.rows(); at += block_size(form, at)) starts.push_back(at);
  std::vector<double> least_before(starts.size()), most_behind(starts.size());
  double least = HUGE_VAL, most = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    least_before[i] = least;
    least = std::min(least, magnitude(form, starts[i]));
  }
  for (std::size_t i = starts.size(); i-- > 0;) most_behind[i] = most = std::max(most, magnitude(form, starts[i]));
  for (std::size_t i = 1; i < starts.size(); ++i) {
    if (least_before[i] > scale_gap * most_behind[i]) result.push_back(starts[i]);
  }
  return result;
}

// How far the entries that couple the blocks exceed the eigenvalues: what cannot be cut apart is followed in a dense
// block, which loses as many digits.
double departure_from_normal(const Matrix& form) {
  double fastest = 0;
  for (Index at = 0; at < form.rows(); at += block_size(form, at)) fastest = std::max(fastest, magnitude(form, at));
  return fastest > 0 ? largest_entry(form) / fastest : 1;
}

// Slow motions of light masses look alike in the metric of their momentum: coordinates of one length then couple far
// faster than anything moves, and nothing told of their growth would hold for longer than that coupling takes. Lengths
// in proportion to how the coordinates move together take it away.
void balance_what_looks_alike(Ordered& part) {
  if (departure_from_normal(part.form) <= most_coupling) return;
  const Matrix scales = balance(part.form);
  part.basis.array().rowwise() *= scales.col(0).transpose().array();
}

// The invariant subspace that the columns span, with a Schur form of its own in a metric of its own time.
Ordered rescaled(const Matrix& form, const Matrix& basis, double time_s) {
  const Index k = basis.rows() / 2;
  Matrix scaled = basis;
  scaled.bottomRows(k) *= Scalar(time_s);
  const Matrix q = twofold::orthonormalised(scaled), r = q.transpose() * scaled;
  const auto schur = twofold::real_schur(r * form * twofold::inverse(r));
  if (!schur.found) return {form, basis};
  Ordered result{schur.form, q * schur.vectors};
  result.basis.bottomRows(k) *= Scalar(1 / time_s);
  return result;
}

// The block of the rest whose eigenvalue is nearest.
Index nearest(const Matrix& form, Index first, Index size) {
  const auto [re, im] = eigenvalue(form, first);
  Index found = first + size;
  double least = HUGE_VAL;
  for (Index at = first + size; at < form.rows(); at += block_size(form, at)) {
    const auto [other_re, other_im] = eigenvalue(form, at);
    const double distance = std::hypot(other_re - re, other_im - im);
    if (distance < least) found = at;
    least = std::min(least, distance);
  }
  return found;
}

// Bavely and Stewart's loop: a block grows by its nearest eigenvalue until it can be cut off.
std::vector<Index> cut_clusters(Ordered& part) {
  const double most =
      std::clamp(most_coupling * departure_from_normal(part.form), most_coupling, most_coupling_of_ill_conditioned);
  std::vector<Index> sizes;
  for (Index first = 0; first < part.size();) {
    Index size = block_size(part.form, first);
    while (first + size < part.size() && !part.decouple(first, size, most)) {
      const Index at = part.raise(nearest(part.form, first, size), first + size);
      size = at + block_size(part.form, at) - first;
    }
    sizes.push_back(size);
    first += size;
  }
  return sizes;
}

}  // namespace

Matrix sylvester(const Matrix& a, const Matrix& b, const Matrix& c) {
  Matrix x = Matrix::Zero(a.rows(), b.rows());
  for (Index column = 0; column < b.rows();) {
    const Index q = block_size(b, column);
    Index end = a.rows();
    while (end > 0) {
      const Index p = end >= 2 && block_size(a, end - 2) == 2 ? 2 : 1, row = end - p, below = a.rows() - end;
      Matrix right = c.block(row, column, p, q) + x.block(row, 0, p, column) * b.block(0, column, column, q);
      right -= a.block(row, end, p, below) * x.block(end, column, below, q);
      const Matrix small = kronecker(a.block(row, row, p, p), b.block(column, column, q, q));
      const Matrix solution = twofold::inverse(small) * right.reshaped(p * q, 1);
      x.block(row, column, p, q) = solution.reshaped(p, q);
      end = row;
    }
    column += q;
  }
  return x;
}

bool exchange(Matrix& form, Matrix& basis, Index first, Index p, Index q) {
  const Index size = p + q;
  const Matrix local = form.block(first, first, size, size);
  const Matrix x = sylvester(local.topLeftCorner(p, p), local.bottomRightCorner(q, q), local.topRightCorner(p, q));
  if (!(largest_entry(x) < 1e30)) return false;
  Matrix both(size, size);
  both << -x, Matrix::Identity(p, p), Matrix::Identity(q, q), Matrix::Zero(q, p);
  const Matrix turn = twofold::orthonormalised(both);
  Matrix turned = turn.transpose() * local * turn;
  if (!(largest_entry(turned.bottomLeftCorner(p, q)) <= 1e-28 * largest_entry(local))) return false;
  form.middleRows(first, size) = (turn.transpose() * form.middleRows(first, size)).eval();
  form.middleCols(first, size) = (form.middleCols(first, size) * turn).eval();
  form.block(first + q, first, p, q).setZero();
  basis.middleCols(first, size) = (basis.middleCols(first, size) * turn).eval();
  return true;
}

// With b the larger of the off-diagonal entries, [1 0; r 1] and r = (d - a) / 2b make both diagonal entries the mean.
PairForm make_pair_form(Matrix& form, Matrix& basis, Index first) {
  const bool upper = abs(form(first, first + 1)) >= abs(form(first + 1, first));
  const Index one = upper ? first : first + 1, other = upper ? first + 1 : first;
  const Scalar a = form(one, one), b = form(one, other), c = form(other, one), d = form(other, other);
  const Scalar half = (d - a) / 2;
  PairForm pair{PairForm::Kind::other, (a + d) / 2, 0, b * c + half * half};
  Scalar unit = 0;
  if (pair.delta_squared < 0 && abs(b) <= most_coupling_of_ill_conditioned * sqrt(-pair.delta_squared)) {
    pair.kind = PairForm::Kind::complex;
    unit = pair.frequency = sqrt(-pair.delta_squared);
  } else if (pair.mean != 0 && abs(pair.delta_squared) <= 1e-4 * pair.mean * pair.mean) {
    pair.kind = PairForm::Kind::critical;
    unit = abs(pair.mean);
  } else {
    return pair;
  }
  Matrix turn(2, 2);
  const Index top = upper ? 0 : 1, bottom = 1 - top;
  turn(top, 0) = 1;
  turn(bottom, 0) = half / b;
  turn(top, 1) = 0;
  turn(bottom, 1) = unit / b;
  const Matrix inverse = twofold::inverse(turn);
  basis.middleCols(first, 2) = (basis.middleCols(first, 2) * turn).eval();
  form.middleCols(first, 2) = (form.middleCols(first, 2) * turn).eval();
  form.middleRows(first, 2) = (inverse * form.middleRows(first, 2)).eval();
  form.block(first, first, 2, 2) << pair.mean, unit, pair.delta_squared / unit, pair.mean;
  return pair;
}

InvariantBlocks invariant_blocks(const Matrix& a) {
  const Index n = a.rows();
  Matrix balanced = a;
  const Matrix scales = balance(balanced);
  const auto schur = twofold::real_schur(balanced);
  if (!schur.found) return {Matrix::Identity(n, n), a, {n}};
  Ordered whole{schur.form, schur.vectors};
  order_by_magnitude(whole);
  whole.basis.array().colwise() *= scales.col(0).array();

  InvariantBlocks result{Matrix::Zero(n, n), Matrix::Zero(n, n), {}};
  std::vector<Index> ends = gaps(whole.form);
  ends.push_back(n);
  Index first = 0;
  double time_s = 1;
  for (const Index end : ends) {
    const Index size = end - first;
    if (end < n && !whole.decouple(first, size, most_scale_coupling)) continue;
    double fastest = 0;
    for (Index at = first; at < end; at += block_size(whole.form, at)) {
      fastest = std::max(fastest, magnitude(whole.form, at));
    }
    if (fastest > no_time_scale * magnitude(whole.form, 0)) time_s = std::ldexp(1.0, -std::ilogb(fastest));
    Ordered part = rescaled(whole.form.block(first, first, size, size), whole.basis.middleCols(first, size), time_s);
    balance_what_looks_alike(part);
    for (const Index block : cut_clusters(part)) result.sizes.push_back(block);
    result.basis.middleCols(first, size) = part.basis;
    result.generator.block(first, first, size, size) = part.form;
    first = end;
  }
  return result;
}

}  // namespace breakaway::hybrid
