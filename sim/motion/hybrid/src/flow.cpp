#include "breakaway/hybrid/flow.hpp"

namespace breakaway::hybrid {
namespace {

using Extended = long double;

ExtendedMatrix companion(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness, Extended time) {
  const Eigen::Index k = damping.rows();
  ExtendedMatrix a = ExtendedMatrix::Zero(2 * k, 2 * k);
  a.topRightCorner(k, k).setIdentity();
  a.bottomLeftCorner(k, k) = -stiffness * time * time;
  a.bottomRightCorner(k, k) = -damping * time;
  return a;
}

// A power of two near the machine's own time: z = (u, time a) has entries of one size.
Extended time_scale(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness) {
  const Extended rate = std::max(std::sqrt(stiffness.cwiseAbs().maxCoeff()), damping.cwiseAbs().maxCoeff());
  return rate > 0 ? std::exp2(-std::round(std::log2(rate))) : 1;
}

}  // namespace

// k x k, in coordinates in which the mass is the identity.
Flow::Flow(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness)
    : k_{damping.rows()},
      modes_{ExtendedMatrix::Zero(2 * k_, 2 * k_)},
      generator_{ExtendedMatrix::Zero(2 * k_, 2 * k_)} {
  if (k_ == 0) return;
  if (!decouple(damping, stiffness) && !diagonalise(damping, stiffness)) keep_dense(damping, stiffness);
  inverse_ = stability::extended::inverse(modes_);
  dense_ = generator_.cast<double>();
  for (const Block& block : blocks_) {
    const double turns = block.kind == Block::Kind::dense ? 1 : 0.25;
    if (block.rate > 0) window_s_ = std::min(window_s_, turns / block.rate);
  }
}

// Returns the factor by which the block's amplitude grows within window_s() at most.
double Flow::growth_of(const Block& block) const {
  const double x = block.rate > 0 ? block.rate * window_s_ : 0;
  const double exponential = 1 + x + x * x;  // >= e^x for 0 <= x <= 1.79
  if (block.kind != Block::Kind::critical) return exponential;
  // In the 1-norm it is e^(mu h) (cosh(delta h) + sinh(delta h) |mu| / delta) with delta <= |mu| / 100, which stays
  // below 1.02 for mu < 0.
  return block.rate < 0 ? 1.02 : exponential * exponential * (1 + x);
}

void Flow::bound(const Block& block, const ExtendedMatrix& row, double* bounds) const {
  const ExtendedMatrix part = row.middleCols(block.first, block.size);
  double* const bound = bounds + block.first;
  const double growth = growth_of(block);
  const auto grown = [growth](Extended size) { return static_cast<double>(size) * growth; };
  switch (block.kind) {
    case Block::Kind::pair:  // along the eigenvectors (1, lambda)
      bound[0] = grown(std::abs(part(0, 0) + part(0, 1) * block.rate));
      bound[1] = grown(std::abs(part(0, 0) + part(0, 1) * block.lesser));
      break;
    case Block::Kind::complex:
      bound[0] = grown(part.stableNorm());
      break;
    case Block::Kind::free:
      bound[1] = grown(std::abs(part(0, 1)));
      break;
    default:
      bound[0] = grown(part.cwiseAbs().maxCoeff());
  }
}

// Symmetric C and K that commute: k scalar oscillators, known without an unsymmetric eigenproblem.
bool Flow::decouple(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness) {
  ExtendedMatrix vectors = ExtendedMatrix::Identity(k_, k_);
  const Extended c_norm = damping.cwiseAbs().maxCoeff(), k_norm = stiffness.cwiseAbs().maxCoeff();
  const auto diagonal_in = [&](const ExtendedMatrix& matrix, Extended norm) {
    ExtendedMatrix rest = vectors.transpose() * matrix * vectors;
    rest.diagonal().setZero();
    return rest.cwiseAbs().maxCoeff() <= 2e-16L * norm;
  };
  if (!diagonal_in(damping, 0) || !diagonal_in(stiffness, 0)) {
    // Eigenvalues of both that coincide in the sum belong together or are told apart by the odd weight.
    ExtendedMatrix sum = ExtendedMatrix::Zero(k_, k_);
    if (k_norm > 0) sum += stiffness / k_norm;
    if (c_norm > 0) sum += 0.6180339887498949L * damping / c_norm;
    vectors = stability::extended::symmetric_eigenvectors((sum + sum.transpose()) / 2);
  }
  if (!diagonal_in(damping, c_norm) || !diagonal_in(stiffness, k_norm)) return false;
  for (Eigen::Index i = 0; i < k_; ++i) {
    const ExtendedVector mode = vectors.col(i);
    add_oscillator(mode, mode.dot(damping * mode), mode.dot(stiffness * mode), 2 * i);
  }
  return true;
}

// u'' + c u' + k u = 0 along one direction.
void Flow::add_oscillator(const ExtendedVector& mode, Extended c, Extended k, Eigen::Index first) {
  const Extended mean = -c / 2, discriminant = mean * mean - k, root = std::sqrt(std::abs(discriminant));
  const auto column = [&](Eigen::Index offset, Extended u, Extended a) {
    modes_.col(first + offset) << u * mode, a * mode;
  };
  if (mean == 0 && root == 0) {
    column(0, 1, 0);
    column(1, 0, 1);
    generator_(first, first + 1) = 1;
    blocks_.push_back({Block::Kind::free, first, 2});
  } else if (root <= 0.01L * std::abs(mean)) {
    const Extended coupling = std::abs(mean);
    column(0, 1, mean);
    column(1, 0, coupling);
    generator_.block(first, first, 2, 2) << mean, coupling, discriminant / coupling, mean;
    Block block{Block::Kind::critical, first, 2, static_cast<double>(mean)};
    block.delta_squared = static_cast<double>(discriminant);
    block.coupling = static_cast<double>(coupling);
    blocks_.push_back(block);
  } else if (discriminant < 0) {
    column(0, 1, mean);
    column(1, 0, root);
    add_complex(first, mean, root);
  } else {
    const Extended large = mean > 0 ? mean + root : mean - root, small = k / large;
    column(0, 1, 0);
    column(1, 0, 1);
    generator_.block(first, first, 2, 2) << 0, 1, -k, -c;
    Block block{Block::Kind::pair, first, 2, static_cast<double>(std::max(large, small))};
    block.lesser = static_cast<double>(std::min(large, small));
    blocks_.push_back(block);
  }
}

void Flow::add_real(Eigen::Index first, Extended value) {
  generator_(first, first) = value;
  blocks_.push_back({Block::Kind::real, first, 1, static_cast<double>(value)});
}

void Flow::add_complex(Eigen::Index first, Extended rate, Extended frequency) {
  generator_.block(first, first, 2, 2) << rate, frequency, -frequency, rate;
  Block block{Block::Kind::complex, first, 2, static_cast<double>(rate)};
  block.frequency = static_cast<double>(frequency);
  const Extended square = rate * rate + frequency * frequency;
  block.inverse_re = static_cast<double>(rate / square);
  block.inverse_im = static_cast<double>(-frequency / square);
  blocks_.push_back(block);
}

bool Flow::diagonalise(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness) {
  const Extended time = time_scale(damping, stiffness);
  const auto eigen = stability::extended::general_eigen(companion(damping, stiffness, time));
  if (!eigen.found) return false;
  ExtendedMatrix vectors(2 * k_, 2 * k_);
  const auto& values = eigen.values;
  for (Eigen::Index i = 0; i < 2 * k_; i += values[i].imag() == 0 ? 1 : 2) {
    vectors.col(i) = eigen.vectors.col(i).real();
    if (values[i].imag() != 0) vectors.col(i + 1) = eigen.vectors.col(i).imag();
  }
  // The change of coordinates can cost 1e-16 times this, relative to the largest coordinate.
  const auto inverse = stability::extended::inverse_if_regular(vectors);
  if (!inverse || !(vectors.norm() * inverse->norm() < 1e4L)) return false;
  for (Eigen::Index i = 0; i < 2 * k_; i += values[i].imag() == 0 ? 1 : 2) {
    if (values[i].imag() == 0) {
      add_real(i, values[i].real() / time);
    } else {
      add_complex(i, values[i].real() / time, values[i].imag() / time);
    }
  }
  modes_ << vectors.topRows(k_), vectors.bottomRows(k_) / time;
  return true;
}

void Flow::keep_dense(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness) {
  const Extended time = time_scale(damping, stiffness);
  generator_ = companion(damping, stiffness, time) / time;
  modes_.setIdentity();
  modes_.bottomRightCorner(k_, k_) /= time;
  const Extended norm = generator_.cwiseAbs().colwise().sum().maxCoeff();
  blocks_.push_back({Block::Kind::dense, 0, 2 * k_, static_cast<double>(norm)});
}

void Flow::propagate_dense(double h, double* x, double* sum) const {
  const Eigen::Index size = dense_.rows();
  Eigen::Map<Eigen::VectorXd> state(x, size), integral(sum, size);
  Eigen::VectorXd term = state * h;
  for (int order = 1; order <= 40; ++order) {
    integral += term;
    const Eigen::VectorXd next = dense_ * term;
    state += next;
    if (next.cwiseAbs().maxCoeff() <= 1e-18 * state.cwiseAbs().maxCoeff()) break;
    term = next * (h / (order + 1));
  }
}

}  // namespace breakaway::hybrid
