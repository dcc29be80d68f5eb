// Flow: the motion y'' + C y' + K y = const of one hybrid mode in closed form, in coordinates in which it falls apart.
//
// The velocity u = y' and the acceleration a = u' obey z' = A z with z = (u, a), whatever the constant force and
// however singular K: no rest position is needed. Modal coordinates x with u = U x make A block diagonal:
//   real      x' = lambda x
//   pair      (x1, x2)' = (x2, (lambda1 + lambda2) x2 - lambda1 lambda2 x1): kept together, since apart they cancel
//   where
//             the motion is short compared with 1 / lambda
//   complex   (x1, x2)' = [alpha beta; -beta alpha] (x1, x2)
//   critical  (x1, x2)' = [mu sigma; delta^2/sigma mu] (x1, x2): two eigenvalues mu +- delta too close to be told apart
//   free      (x1, x2)' = (x2, 0): a mass without spring or damper
//   dense     x' = A x with a small A, where the eigenvectors are too ill-conditioned to be used: see DenseBlock.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "breakaway/hybrid/dense_block.hpp"
#include "breakaway/stability/twofold.hpp"

namespace breakaway::hybrid {

// Factorisations are done once a mode and in extended precision, so that they lose nothing in double.
using Extended = stability::twofold::Scalar;
using ExtendedMatrix = stability::twofold::Matrix;
using ExtendedVector = stability::twofold::Vector;

struct Block {
  enum class Kind { real, pair, complex, critical, free, dense };
  Kind kind;
  Eigen::Index first;    // coordinate
  Eigen::Index size;     // coordinates
  double rate = 0;       // lambda, alpha or mu, the greater of a pair; DenseBlock::rate()
  double lesser = 0;     // the other eigenvalue of a pair
  double frequency = 0;  // beta
  double delta_squared = 0;
  double coupling = 1;    // sigma
  double inverse_re = 0;  // 1 / (alpha + i beta)
  double inverse_im = 0;
  double speed = 0;       // the size of the largest eigenvalue
  std::size_t dense = 0;  // among the dense blocks
};

class Flow {
 public:
  Flow() = default;

  // k x k, in coordinates in which the mass is the identity. Throws Refused where even extended precision cannot tell
  // the motions apart.
  Flow(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness);

  // The same where the last `drivers` coordinates act on the others and nothing acts on them: their rows of C and K are
  // zero but for the diagonal. Returns nothing unless each relaxes at two rates well apart that the others do not have.
  static std::optional<Flow> driven(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness,
                                    Eigen::Index drivers);

  Eigen::Index size() const { return 2 * k_; }
  const std::vector<Block>& blocks() const { return blocks_; }  // the fastest first
  double fastest() const { return blocks_.empty() ? 0 : blocks_.front().speed; }
  // The least rate of a motion that moves at all, 0 if there is a block whose rates are not told apart.
  double slowest() const;
  ExtendedMatrix velocity() const { return modes_.topRows(k_); }               // u = velocity x
  ExtendedMatrix from_velocity() const { return inverse_.leftCols(k_); }       // x = from_velocity u
  ExtendedMatrix from_acceleration() const { return inverse_.rightCols(k_); }  //   + from_acceleration a
  const ExtendedMatrix& generator() const { return generator_; }               // x' = generator x

  // bound() holds so far ahead: until what grows has grown by a quarter, or for ever.
  double window_s() const { return window_s_; }

  // Says whether the motion dies away in every block that takes part in it.
  bool decays(const double* x) const {
    return std::all_of(blocks_.begin(), blocks_.end(), [this, x](const Block& block) {
      const bool decays = block.kind == Block::Kind::dense ? dense_[block.dense].decays() : block.rate < 0;
      return decays || norm1(x + block.first, block.size) == 0;
    });
  }

  // Says whether no block's amplitude can grow without bound.
  bool bounded() const { return bounded_; }

  // x <- e^(A h) x and integral <- integral + the integral of x over h.
  void propagate(double h, double* x, double* integral) const {
    for (const Block& block : blocks_) {
      double *const state = x + block.first, *const sum = integral + block.first;
      switch (block.kind) {
        case Block::Kind::real:
          propagate_real(block, h, *state, *sum);
          break;
        case Block::Kind::pair:
          propagate_pair(block, h, state, sum);
          break;
        case Block::Kind::complex:
          propagate_complex(block, h, state, sum);
          break;
        case Block::Kind::critical:
          propagate_critical(block, h, state, sum);
          break;
        case Block::Kind::free:
          propagate_free(h, state, sum);
          break;
        case Block::Kind::dense:
          dense_[block.dense].propagate(h, state, sum);
          break;
      }
    }
  }

  // Sizes of the block's coordinates: a linear form of x is at most the sum of bound() times them for the next
  // window_s(). For a free mass: a form of x2 alone, as derivatives of anything are.
  void amplitudes(const Block& block, const double* x, double* sizes) const {
    const double* const state = x + block.first;
    double* const size = sizes + block.first;
    switch (block.kind) {
      case Block::Kind::pair: {
        const double apart = 1 / (block.rate - block.lesser);
        size[0] = std::abs((state[1] - block.lesser * state[0]) * apart);
        size[1] = std::abs((state[1] - block.rate * state[0]) * apart);
        break;
      }
      case Block::Kind::complex: {
        // This is at least the Euclidean norm and at most 8 % more, and it does not overflow.
        const double a = std::abs(state[0]), b = std::abs(state[1]);
        size[0] = std::max(a, b) + 0.41421356237309515 * std::min(a, b);
        break;
      }
      case Block::Kind::free:
        size[1] = std::abs(state[1]);
        break;
      case Block::Kind::dense:
        size[0] = dense_[block.dense].amplitude(state);
        break;
      default:
        size[0] = norm1(state, block.size);
    }
  }
  enum class Horizon { window, ever };  // `ever` bounds nothing where bounded() is false
  void bound(const Block& block, const ExtendedMatrix& row, Horizon horizon, double* bounds) const;

 private:
  void survey();
  bool resounds_at(double rate) const;
  bool decouple(const ExtendedMatrix& damping, const ExtendedMatrix& stiffness);
  void add_oscillator(const ExtendedVector& mode, Extended c, Extended k, Eigen::Index first);
  void add_real(Eigen::Index first, Extended value);
  void add_complex(Eigen::Index first, Extended rate, Extended frequency);
  void add_critical(Eigen::Index first, Extended mean, Extended delta_squared);
  void split(const ExtendedMatrix& companion);
  void add_block(Eigen::Index first, Eigen::Index size, double noise);
  void add_free(Eigen::Index first);
  void add_dense(Eigen::Index first, Eigen::Index size);
  bool invert(const ExtendedMatrix& companion, double tolerance);
  double growth_of(const Block& block, Horizon horizon) const;

  static double norm1(const double* x, Eigen::Index size) {
    double sum = 0;
    for (Eigen::Index i = 0; i < size; ++i) sum += std::abs(x[i]);
    return sum;
  }

  static void propagate_real(const Block& block, double h, double& x, double& sum) {
    sum += x * integral(block.rate, h);
    x += x * std::expm1(block.rate * h);
  }

  static void propagate_complex(const Block& block, double h, double* x, double* sum) {
    const double re = block.rate * h, im = block.frequency * h;
    double change_re = 0, change_im = 0;  // e^(lambda h) - 1
    const double turn = std::max(std::abs(re), std::abs(im));
    if (turn < 0.03) {
      for (int order = turn < 1e-5 ? 3 : turn < 2e-3 ? 5 : 8; order >= 1; --order) {
        const double old_re = 1 + change_re;
        change_re = (re * old_re - im * change_im) * reciprocal[order];
        change_im = (re * change_im + im * old_re) * reciprocal[order];
      }
    } else {
      const double size = std::exp(re);
      change_re = size * std::cos(im) - 1;
      change_im = size * std::sin(im);
    }
    // (e^(lambda h) - 1) / lambda.
    const double mean_re = change_re * block.inverse_re - change_im * block.inverse_im;
    const double mean_im = change_re * block.inverse_im + change_im * block.inverse_re;
    // x1 - i x2 turns with e^(lambda h).
    sum[0] += mean_re * x[0] + mean_im * x[1];
    sum[1] += mean_re * x[1] - mean_im * x[0];
    const double x0 = x[0];
    x[0] += change_re * x[0] + change_im * x[1];
    x[1] += change_re * x[1] - change_im * x0;
  }

  // (e^(lambda h) - 1) / lambda, also where 1 / lambda overflows.
  static double integral(double lambda, double h) {
    return std::abs(lambda * h) < 1e-290 ? h : std::expm1(lambda * h) / lambda;
  }

  // The integral over h of (e^(other t) - e^(one t)) / (other - one), with that of e^(one t) given.
  static double integral_of_difference(double one, double other, double h, double integral_of_one) {
    if (std::max(std::abs(one), std::abs(other)) * h > 0.5) {
      return (integral(other, h) - integral_of_one) / (other - one);
    }
    // sum of h^(j + 2) / (j + 2)! times the sum of one^i other^(j - i).
    double symmetric = 1, power = 1, term = 0.5 * h * h, sum = term;
    for (int j = 1; j <= 13; ++j) {
      power *= one * h;
      symmetric = symmetric * other * h + power;
      term *= 1.0 / (j + 2);
      sum += term * symmetric;
    }
    return sum;
  }

  static void propagate_pair(const Block& block, double h, double* x, double* sum) {
    const double one = block.lesser, other = block.rate, product = one * other;
    const double decay = std::exp(one * h);
    const double apart = other - one;
    const double rise = std::expm1(apart * h);
    // The divided differences of e^(lambda h): s, and its integral t.
    const double s = (std::isfinite(rise) ? decay * rise : std::exp(other * h)) / apart;
    const double first = decay - one * s, second = decay + other * s;
    const double u = x[0], a = x[1];
    x[0] = first * u + s * a;
    x[1] = second * a - product * s * u;
    // The integral of a is the change of u.
    sum[1] += x[0] - u;
    const double p = integral(one, h), t = integral_of_difference(one, other, h, p);
    sum[0] += (p - one * t) * u + t * a;
  }

  static void propagate_free(double h, double* x, double* sum) {
    sum[0] += h * (x[0] + 0.5 * h * x[1]);
    sum[1] += h * x[1];
    x[0] += h * x[1];
  }

  static void propagate_critical(const Block& block, double h, double* x, double* sum) {
    const double mu = block.rate, sigma = block.coupling, back = block.delta_squared / sigma;
    const double a = x[0], b = x[1];
    const double square = block.delta_squared * h * h;
    if (std::abs(mu * h) < 0.1) {
      double term0 = a * h, term1 = b * h;
      for (int order = 1; order <= 14; ++order) {
        sum[0] += term0;
        sum[1] += term1;
        const double f0 = mu * term0 + sigma * term1, f1 = back * term0 + mu * term1;
        x[0] += f0;
        x[1] += f1;
        const double next = h * reciprocal[order + 1];
        term0 = f0 * next;
        term1 = f1 * next;
      }
      return;
    }
    // e^(mu h) cosh(root) and e^(mu h) sinh(root)/root, or cos and sin: two exponentials where one would overflow, and
    // two terms of the series where they cancel.
    const double root = std::sqrt(std::abs(square)), size = std::exp(mu * h);
    const double rise = 0.5 * std::exp(mu * h + root), fall = 0.5 * std::exp(mu * h - root);
    const double sine = root < 1e-3  ? size * (1 + square / 6)
                        : square < 0 ? size * std::sin(root) / root
                        : root < 0.5 ? size * std::sinh(root) / root
                                     : (rise - fall) / root;
    const double cosine = square > 0 ? rise + fall : size * std::cos(root);
    x[0] = cosine * a + sigma * h * sine * b;
    x[1] = cosine * b + back * h * sine * a;
    const double determinant = mu * mu - block.delta_squared;
    sum[0] += (mu * (x[0] - a) - sigma * (x[1] - b)) / determinant;
    sum[1] += (mu * (x[1] - b) - back * (x[0] - a)) / determinant;
  }

  static constexpr double reciprocal[] = {0,       1.0,     1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6,  1.0 / 7,
                                          1.0 / 8, 1.0 / 9, 1.0 / 10, 1.0 / 11, 1.0 / 12, 1.0 / 13, 1.0 / 14, 1.0 / 15};

  Eigen::Index k_ = 0;
  double window_s_ = std::numeric_limits<double>::infinity();
  std::vector<Block> blocks_;
  ExtendedMatrix modes_;  // (u, a) = modes x
  ExtendedMatrix inverse_;
  ExtendedMatrix generator_;
  std::vector<DenseBlock> dense_;
  bool bounded_ = true;
};

}  // namespace breakaway::hybrid
