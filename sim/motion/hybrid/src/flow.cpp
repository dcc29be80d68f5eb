#include "breakaway/hybrid/flow.hpp"

#include <algorithm>
#include <functional>

#include "breakaway/hybrid/invariant_blocks.hpp"
#include "breakaway/hybrid/refused.hpp"

namespace breakaway::hybrid {
namespace {

// What the two ways to take a motion apart may leave of the motion's own rate.
constexpr double rounding_of_decoupled = 1e-14;
constexpr double rounding_of_blocks = 1e-13;

ExtendedMatrix companion(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness) {
  const Eigen::Index k = damping.rows();
  ExtendedMatrix a = ExtendedMatrix::Zero(2 * k, 2 * k);
  a.topRightCorner(k, k).setIdentity();
  a.bottomLeftCorner(k, k) = -stiffness;
  a.bottomRightCorner(k, k) = -damping;
  return a;
}

template <class Matrix>
double largest(const Matrix& matrix) {
  return static_cast<double>(matrix.cwiseAbs().maxCoeff());
}

// What the digits of extended precision leave undecided of the generator inverse A modes.
Eigen::MatrixXd rounding(const ExtendedMatrix& companion, const ExtendedMatrix& modes, const ExtendedMatrix& inverse) {
  const auto sizes = [](const ExtendedMatrix& matrix) { return matrix.cwiseAbs().template cast<double>().eval(); };
  return 0x1p-96 * (sizes(inverse) * (sizes(companion) * sizes(modes)));
}

// Returns 0 for what is rounding only in v^T A v.
Extended quadratic_form(const ExtendedVector& v, const ExtendedMatrix& a) {
  const Extended value = v.dot(a * v);
  const ExtendedVector sizes = v.cwiseAbs();
  return abs(value) <= 0x1p-96 * sizes.dot(a.cwiseAbs() * sizes) ? Extended(0) : value;
}

}  // namespace

// k x k, in coordinates in which the mass is the identity.
Flow::Flow(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness)
    : k_{damping.rows()},
      modes_{ExtendedMatrix::Zero(2 * k_, 2 * k_)},
      generator_{ExtendedMatrix::Zero(2 * k_, 2 * k_)} {
  if (k_ == 0) return;
  const ExtendedMatrix a = companion(damping, stiffness);
  if (!decouple(damping, stiffness) || !invert(a, rounding_of_decoupled)) {
    split(a);
    if (!invert(a, rounding_of_blocks)) {
      // What no spring holds has motions that stand still, which look like those that only dampers end, slowly.
      const bool held = (stiffness.cwiseAbs().rowwise().sum().array() > 0).all();
      throw Refused{"this machine's motions are too different in their time scales to be told apart in 31 digits",
                    held ? "hold its stiffest springs rigid"
                         : "give each coordinate that no spring holds a weak one, as of 1e-6 N/m for each kg",
                    "set [run] integrator to \"adaptive\""};
    }
  }
  survey();
}

// What the blocks say together.
void Flow::survey() {
  std::ranges::stable_sort(blocks_, std::greater{}, &Block::speed);
  for (const Block& block : blocks_) {
    if (block.rate > 0) window_s_ = std::min(window_s_, 0.25 / block.rate);
    const bool dense = block.kind == Block::Kind::dense;
    bounded_ = bounded_ && (dense ? dense_[block.dense].growth() < HUGE_VAL : block.rate <= 0);
  }
}

// A driver's mode with the rate r is (g, 1) e^(r t), g being what the others answer: (r^2 + r C + K) g = -(r c + k).
std::optional<Flow> Flow::driven(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness, Eigen::Index drivers) {
  const Eigen::Index k = damping.rows(), moved = k - drivers, first = 2 * moved;
  const ExtendedMatrix own_damping = damping.topLeftCorner(moved, moved),
                       own_stiffness = stiffness.topLeftCorner(moved, moved);
  const Flow own{own_damping, own_stiffness};
  Flow flow = own;
  flow.k_ = k;
  for (ExtendedMatrix* const matrix : {&flow.modes_, &flow.inverse_, &flow.generator_}) matrix->setZero(2 * k, 2 * k);
  flow.generator_.topLeftCorner(first, first) = own.generator_;
  flow.modes_.block(0, 0, moved, first) = own.modes_.topRows(moved);
  flow.modes_.block(k, 0, moved, first) = own.modes_.bottomRows(moved);
  if (moved > 0) {
    flow.inverse_.block(0, 0, first, moved) = own.inverse_.leftCols(moved);
    flow.inverse_.block(0, k, first, moved) = own.inverse_.rightCols(moved);
  }
  for (Eigen::Index driver = moved; driver < k; ++driver) {
    const Extended mean = -damping(driver, driver) / 2, square = mean * mean - stiffness(driver, driver);
    if (!(square > mean * mean / 100)) return {};
    const Extended large = mean > 0 ? mean + sqrt(square) : mean - sqrt(square);
    const Extended rates[] = {large, stiffness(driver, driver) / large}, apart = rates[0] - rates[1];
    const Eigen::Index column = first + 2 * (driver - moved);
    for (Eigen::Index i = 0; i < 2; ++i) {
      const Extended rate = rates[i];
      const ExtendedMatrix dynamic =
          ExtendedMatrix::Identity(moved, moved) * (rate * rate) + own_damping * rate + own_stiffness;
      const auto response = stability::twofold::inverse_if_regular(dynamic);
      if (own.resounds_at(static_cast<double>(rate)) || !response) return {};
      ExtendedMatrix mode = ExtendedMatrix::Zero(k, 1);
      mode.topRows(moved) =
          -(*response * (damping.block(0, driver, moved, 1) * rate + stiffness.block(0, driver, moved, 1)));
      mode(driver, 0) = 1;
      flow.modes_.col(column + i) << mode, mode * rate;
      flow.add_real(column + i, rate);
      flow.inverse_(column + i, driver) = (i == 0 ? -rates[1] : rates[0]) / apart;
      flow.inverse_(column + i, k + driver) = (i == 0 ? Extended(1) : Extended(-1)) / apart;
    }
  }
  const ExtendedMatrix answered = flow.modes_.rightCols(2 * drivers) * flow.inverse_.bottomRows(2 * drivers);
  flow.inverse_.topRows(first) -= (flow.inverse_.topRows(first) * answered).eval();
  flow.survey();
  return flow;
}

// Says whether a mode moves at this rate, or so near it that the two could hardly be told apart.
bool Flow::resounds_at(double rate) const {
  const auto near = [rate](double re, double im) { return std::hypot(re - rate, im) < 1e-3 * std::abs(rate); };
  return std::ranges::any_of(blocks_, [&](const Block& block) {
    switch (block.kind) {
      case Block::Kind::pair:
        return near(block.rate, 0) || near(block.lesser, 0);
      case Block::Kind::complex:
        return near(block.rate, block.frequency);
      case Block::Kind::dense:
        return std::abs(rate) < 2 * block.speed;
      default:
        return near(block.rate, 0);
    }
  });
}

// Inverts the modes and says whether what they leave out of the motion is rounding: A modes = modes generator, compared
// with the rates of the two blocks that an entry would couple. Blocks that do not move but by rounding stand still.
bool Flow::invert(const ExtendedMatrix& companion, double tolerance) {
  inverse_ = stability::twofold::inverse(modes_);
  const ExtendedMatrix rest = inverse_ * (companion * modes_) - generator_;
  const Eigen::MatrixXd noise = rounding(companion, modes_, inverse_);
  for (const Block& row : blocks_) {
    for (const Block& column : blocks_) {
      const double speed = std::max(row.speed, column.speed);
      const auto range = [&](const auto& matrix) {
        return largest(matrix.block(row.first, column.first, row.size, column.size));
      };
      const double error = range(rest);
      const bool stands = error <= range(noise) && speed <= 100 * error;
      if (!(error <= tolerance * speed) && !stands) return false;
    }
  }
  return true;
}

double Flow::slowest() const {
  double least = fastest();
  for (const Block& block : blocks_) {
    if (block.kind == Block::Kind::dense) return 0;
    const double rate =
        block.kind == Block::Kind::pair ? std::min(std::abs(block.rate), std::abs(block.lesser)) : block.speed;
    if (rate > 0) least = std::min(least, rate);
  }
  return least;
}

// Returns the factor by which the block's amplitude grows within window_s(), or ever, at most.
double Flow::growth_of(const Block& block, Horizon horizon) const {
  if (block.kind == Block::Kind::dense && horizon == Horizon::ever) return dense_[block.dense].growth();
  const double x = block.rate > 0 ? block.rate * window_s_ : 0;
  const double exponential = 1 + x + x * x;  // >= e^x for 0 <= x <= 1.79
  if (block.kind != Block::Kind::critical) return exponential;
  // In the 1-norm it is e^(mu h) (cosh(delta h) + sinh(delta h) |mu| / delta) with delta <= |mu| / 100, which stays
  // below 1.02 for mu < 0.
  return block.rate < 0 ? 1.02 : exponential * exponential * (1 + x);
}

void Flow::bound(const Block& block, const ExtendedMatrix& row, Horizon horizon, double* bounds) const {
  const Eigen::RowVectorXd part = row.middleCols(block.first, block.size).cast<double>();
  double* const bound = bounds + block.first;
  const double growth = growth_of(block, horizon);
  switch (block.kind) {
    case Block::Kind::pair: {  // along the eigenvectors (1, lambda)
      const Extended one = row(0, block.first), other = row(0, block.first + 1);
      bound[0] = growth * std::abs(static_cast<double>(one + other * block.rate));
      bound[1] = growth * std::abs(static_cast<double>(one + other * block.lesser));
      break;
    }
    case Block::Kind::complex:
      bound[0] = growth * part.stableNorm();
      break;
    case Block::Kind::free:
      bound[1] = growth * std::abs(part[1]);
      break;
    case Block::Kind::dense:
      // Where nothing is known to be bound for ever, 0 times infinity is no bound either.
      bound[0] = growth < HUGE_VAL ? growth * dense_[block.dense].bound(part) : growth;
      break;
    default:
      bound[0] = growth * part.cwiseAbs().maxCoeff();
  }
}

// Symmetric C and K that commute: k scalar oscillators, known without an unsymmetric eigenproblem.
bool Flow::decouple(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness) {
  ExtendedMatrix vectors = ExtendedMatrix::Identity(k_, k_);
  const double c_norm = largest(damping), k_norm = largest(stiffness);
  const auto diagonal_in = [&](const ExtendedMatrix& matrix, double norm) {
    ExtendedMatrix rest = vectors.transpose() * matrix * vectors;
    rest.diagonal().setZero();
    return largest(rest) <= 2e-16 * norm;
  };
  if (!diagonal_in(damping, 0) || !diagonal_in(stiffness, 0)) {
    // Eigenvalues of both that coincide in the sum belong together or are told apart by the odd weight.
    ExtendedMatrix sum = ExtendedMatrix::Zero(k_, k_);
    if (k_norm > 0) sum += stiffness / Extended(k_norm);
    if (c_norm > 0) sum += damping * Extended(0.6180339887498949 / c_norm);
    vectors = stability::twofold::symmetric_eigenvectors((sum + sum.transpose()) * Extended(0.5));
  }
  if (!diagonal_in(damping, c_norm) || !diagonal_in(stiffness, k_norm)) return false;
  for (Eigen::Index i = 0; i < k_; ++i) {
    const ExtendedVector mode = vectors.col(i);
    add_oscillator(mode, quadratic_form(mode, damping), quadratic_form(mode, stiffness), 2 * i);
  }
  return true;
}

// u'' + c u' + k u = 0 along one direction.
void Flow::add_oscillator(const ExtendedVector& mode, Extended c, Extended k, Eigen::Index first) {
  const Extended mean = -c / 2, discriminant = mean * mean - k, root = sqrt(abs(discriminant));
  const auto column = [&](Eigen::Index offset, Extended u, Extended a) {
    modes_.col(first + offset) << u * mode, a * mode;
  };
  if (mean == 0 && root == 0) {
    column(0, 1, 0);
    column(1, 0, 1);
    generator_(first, first + 1) = 1;
    blocks_.push_back({Block::Kind::free, first, 2});
  } else if (root <= 0.01 * abs(mean)) {
    column(0, 1, mean);
    column(1, 0, abs(mean));
    add_critical(first, mean, discriminant);
  } else if (discriminant < 0) {
    column(0, 1, mean);
    column(1, 0, root);
    add_complex(first, mean, root);
  } else {
    const Extended large = mean > 0 ? mean + root : mean - root, small = k / large;
    column(0, 1, 0);
    column(1, 0, 1);
    generator_.block(first, first, 2, 2) << 0, 1, -k, -c;
    const double one = static_cast<double>(large), other = static_cast<double>(small);
    Block block{Block::Kind::pair, first, 2, std::max(one, other)};
    block.lesser = std::min(one, other);
    block.speed = std::abs(one);
    blocks_.push_back(block);
  }
}

void Flow::add_real(Eigen::Index first, Extended value) {
  generator_(first, first) = value;
  Block block{Block::Kind::real, first, 1, static_cast<double>(value)};
  block.speed = std::abs(block.rate);
  blocks_.push_back(block);
}

void Flow::add_complex(Eigen::Index first, Extended rate, Extended frequency) {
  generator_.block(first, first, 2, 2) << rate, frequency, -frequency, rate;
  Block block{Block::Kind::complex, first, 2, static_cast<double>(rate)};
  block.frequency = static_cast<double>(frequency);
  const Extended size = sqrt(rate * rate + frequency * frequency);
  block.inverse_re = static_cast<double>(rate / size / size);
  block.inverse_im = static_cast<double>(-frequency / size / size);
  block.speed = static_cast<double>(size);
  blocks_.push_back(block);
}

void Flow::add_critical(Eigen::Index first, Extended mean, Extended delta_squared) {
  const Extended coupling = abs(mean);
  generator_.block(first, first, 2, 2) << mean, coupling, delta_squared / coupling, mean;
  Block block{Block::Kind::critical, first, 2, static_cast<double>(mean)};
  block.delta_squared = static_cast<double>(delta_squared);
  block.coupling = block.speed = static_cast<double>(coupling);
  blocks_.push_back(block);
}

// Any C and K: the companion matrix in blocks that can be told apart.
void Flow::split(const ExtendedMatrix& companion) {
  blocks_.clear();
  dense_.clear();
  const InvariantBlocks parts = invariant_blocks(companion);
  modes_ = parts.basis;
  generator_ = parts.generator;
  const ExtendedMatrix inverse = stability::twofold::inverse(modes_);
  const Eigen::MatrixXd noise = rounding(companion, modes_, inverse);
  // The rate that a mode has, which is exactly zero for one that stands: its eigenvalue is so to the fastest's
  // rounding.
  const ExtendedMatrix rates = inverse * (companion * modes_);
  Eigen::Index first = 0;
  for (const Eigen::Index size : parts.sizes) {
    if (size == 1) generator_(first, first) = rates(first, first);
    add_block(first, size, noise.block(first, first, size, size).maxCoeff());
    first += size;
  }
}

// `noise`: what is rounding in the block's entries.
void Flow::add_block(Eigen::Index first, Eigen::Index size, double noise) {
  if (size == 1) {
    const Extended value = generator_(first, first);
    return add_real(first, abs(value) <= noise ? Extended(0) : value);
  }
  if (size > 2) return add_dense(first, size);
  const PairForm pair = make_pair_form(generator_, modes_, first);
  if (pair.kind == PairForm::Kind::complex) return add_complex(first, pair.mean, pair.frequency);
  if (pair.kind == PairForm::Kind::critical) return add_critical(first, pair.mean, pair.delta_squared);
  if (abs(pair.mean) <= noise && abs(pair.delta_squared) <= noise * abs(generator_(first, first + 1))) {
    return add_free(first);
  }
  add_dense(first, size);
}

// Two coordinates of which the second drives the first and nothing drives the second, to rounding.
void Flow::add_free(Eigen::Index first) {
  modes_.col(first + 1) /= generator_(first, first + 1);
  generator_.block(first, first, 2, 2) << 0, 1, 0, 0;
  blocks_.push_back({Block::Kind::free, first, 2});
}

void Flow::add_dense(Eigen::Index first, Eigen::Index size) {
  for (Eigen::Index at = first; at + 1 < first + size; ++at) {
    if (generator_(at + 1, at) != 0) make_pair_form(generator_, modes_, at);
  }
  dense_.emplace_back(generator_.block(first, first, size, size));
  Block block{Block::Kind::dense, first, size, dense_.back().rate()};
  block.speed = dense_.back().speed();
  block.dense = dense_.size() - 1;
  blocks_.push_back(block);
}

}  // namespace breakaway::hybrid
