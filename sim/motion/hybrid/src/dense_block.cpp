#include "breakaway/hybrid/dense_block.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace breakaway::hybrid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using stability::twofold::Matrix;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int most_powers = 64;
// What couples the parts may make the norm grow at this share of the fastest eigenvalue: a turn of an oscillation sees
// nothing of that.
constexpr double growth_share = 0.05;

double column_norm(const MatrixXd& matrix) { return matrix.cwiseAbs().colwise().sum().maxCoeff(); }

// The largest x^T A x over |x| = 1, and the largest eigenvalue's size, of one or two coordinates.
double logarithmic_norm(const MatrixXd& a) {
  if (a.rows() == 1) return a(0, 0);
  return (a(0, 0) + a(1, 1)) / 2 + std::hypot((a(0, 0) - a(1, 1)) / 2, (a(0, 1) + a(1, 0)) / 2);
}

double largest_eigenvalue(const MatrixXd& a) {
  if (a.rows() == 1) return std::abs(a(0, 0));
  const double half = (a(0, 0) - a(1, 1)) / 2, square = half * half + a(0, 1) * a(1, 0);
  const double mean = (a(0, 0) + a(1, 1)) / 2;
  return square < 0 ? std::hypot(mean, std::sqrt(-square)) : std::abs(mean) + std::sqrt(square);
}

}  // namespace

DenseBlock::DenseBlock(const Matrix& form) : a_{form.cast<double>()} {
  for (Index at = 0; at < a_.rows(); at += parts_.back().size) {
    const Index size = at + 1 < a_.rows() && a_(at + 1, at) != 0 ? 2 : 1;
    parts_.push_back({at, size, 1});
  }
  weigh();
  square(form);
}

void DenseBlock::weigh() {
  const auto count = static_cast<Index>(parts_.size());
  MatrixXd sizes(count, count);  // logarithmic norms on the diagonal
  double slowest = -infinite;
  for (Index r = 0; r < count; ++r) {
    for (Index c = 0; c < count; ++c) {
      const Part &row = parts_[static_cast<std::size_t>(r)], &column = parts_[static_cast<std::size_t>(c)];
      const MatrixXd block = a_.block(row.first, column.first, row.size, column.size);
      sizes(r, c) = r == c ? logarithmic_norm(block) : block.norm();
      if (r == c) speed_ = std::max(speed_, largest_eigenvalue(block));
    }
    slowest = std::max(slowest, sizes(r, r));
  }
  // Decay is proved in a norm that may be a bad measure of the next moment, and the next moment in another.
  const auto lasting = weights(sizes, std::abs(slowest) / 2);
  decays_ = slowest < 0 && rate_of(sizes, lasting) <= 0;
  const auto now =
      weights(sizes, speed_ > 1e-9 * sizes.norm() ? std::max(std::abs(slowest) / 2, growth_share * speed_) : infinite);
  rate_ = rate_of(sizes, now);
  double most = 0, least = infinite;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    parts_[i].weight = now[i];
    most = std::max(most, lasting[i] / now[i]);
    least = std::min(least, lasting[i] / now[i]);
  }
  growth_ = decays_ ? most / least : infinite;
}

// Weights with which each part is driven by those before it at no more than the given rate.
std::vector<double> DenseBlock::weights(const MatrixXd& sizes, double most_coupling) const {
  std::vector<double> result;
  double last = 1;
  for (Index c = 0; c < sizes.cols(); ++c) {
    double coupling = 0;
    for (Index r = 0; r < c; ++r) coupling += sizes(r, c) / result[static_cast<std::size_t>(r)];
    if (coupling * last > most_coupling && most_coupling > 0) last = most_coupling / coupling;
    result.push_back(last);
  }
  return result;
}

double DenseBlock::rate_of(const MatrixXd& sizes, const std::vector<double>& weights) const {
  double rate = -infinite;
  for (Index c = 0; c < sizes.cols(); ++c) {
    double sum = 0;
    for (Index r = 0; r < sizes.rows(); ++r) {
      const double share = weights[static_cast<std::size_t>(c)] / weights[static_cast<std::size_t>(r)];
      sum += r == c ? sizes(r, c) : sizes(r, c) * share;
    }
    rate = std::max(rate, sum);
  }
  return rate;
}

double DenseBlock::amplitude(const double* x) const {
  double sum = 0;
  for (const Part& part : parts_) {
    const double* const state = x + part.first;
    sum += (part.size == 1 ? std::abs(state[0]) : std::hypot(state[0], state[1])) / part.weight;
  }
  return sum;
}

double DenseBlock::bound(const Eigen::RowVectorXd& row) const {
  double most = 0;
  for (const Part& part : parts_) {
    most = std::max(most, row.segment(part.first, part.size).stableNorm() * part.weight);
  }
  return most;
}

void DenseBlock::square(const Matrix& a) {
  const Index n = a.rows();
  const double norm = column_norm(a_);
  double h = norm > 0 && std::isfinite(norm) ? std::ldexp(1.0, -std::ilogb(norm) - 2) : 1;
  Matrix exponential = Matrix::Identity(n, n), integral = Matrix::Zero(n, n), term = exponential;
  for (int order = 1; order <= 24; ++order) {  // 0.5^24 / 24! < 1e-30
    term = (term * (stability::twofold::Scalar(h) / order)).eval();
    integral += term;
    term = (a * term).eval();
    exponential += term;
  }
  for (int power = 0; power < most_powers; ++power) {
    powers_.push_back({h, exponential.cast<double>(), integral.cast<double>()});
    const double size = column_norm(powers_.back().exponential);
    if (!(size < 1e150) || size < 1e-300) break;
    integral += (exponential * integral).eval();
    exponential = (exponential * exponential).eval();
    h *= 2;
  }
}

void DenseBlock::propagate(double h, double* x, double* integral) const {
  Eigen::Map<Eigen::VectorXd> state(x, a_.rows()), sum(integral, a_.rows());
  for (auto power = powers_.rbegin(); power != powers_.rend(); ++power) {
    for (int repeat = 0; h >= power->h; ++repeat) {
      if (repeat == 1000) {  // farther than double can tell time
        state.setConstant(std::numeric_limits<double>::quiet_NaN());
        return;
      }
      if (!state.any()) return;
      sum += power->integral * state;
      state = (power->exponential * state).eval();
      h -= power->h;
    }
  }
  if (h != 0) sum_series(h, state, sum);
}

void DenseBlock::sum_series(double h, Eigen::Ref<Eigen::VectorXd> x, Eigen::Ref<Eigen::VectorXd> integral) const {
  Eigen::VectorXd term = x * h;
  for (int order = 1; order <= 40; ++order) {
    integral += term;
    const Eigen::VectorXd next = a_ * term;
    x += next;
    if (next.cwiseAbs().maxCoeff() <= 1e-18 * x.cwiseAbs().maxCoeff()) break;
    term = next * (h / (order + 1));
  }
}

}  // namespace breakaway::hybrid
