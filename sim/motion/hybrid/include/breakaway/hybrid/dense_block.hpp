// DenseBlock: x' = A x where the eigenvectors of A are too ill-conditioned to be used.
//
// e^(A h) is put together from e^(A d), e^(2 A d), e^(4 A d), ..., which are squared once in extended precision and
// then rounded, and from a Taylor series for what is left of h; so a long time costs a few products of a matrix and a
// vector. The size of x is measured in a norm sum |x_b| / d_b over the diagonal blocks of a real Schur form, with
// weights d_b that make what couples the blocks small: then the norm grows no faster than e^(rate t), and rate is below
// zero or small although |A| is not.
#pragma once

#include <vector>

#include "breakaway/stability/twofold.hpp"

namespace breakaway::hybrid {

class DenseBlock {
 public:
  // `form`: a real Schur form, its blocks of two scaled to [re im; -im re] where that is well conditioned. Any square
  // matrix is allowed, at the price of a greater rate().
  explicit DenseBlock(const stability::twofold::Matrix& form);

  double speed() const { return speed_; }  // the size of the largest eigenvalue
  bool decays() const { return decays_; }  // all of it
  double rate() const { return rate_; }    // amplitude(x(t)) <= e^(rate t) amplitude(x(0))
  double growth() const {
    return growth_;
  }  // amplitude(x(t)) <= growth amplitude(x(0)) for all t > 0; infinite if unknown

  double amplitude(const double* x) const;
  // The largest |row x| over amplitude(x) = 1.
  double bound(const Eigen::RowVectorXd& row) const;

  // x <- e^(A h) x and integral <- integral + the integral of x over h.
  void propagate(double h, double* x, double* integral) const;

 private:
  struct Part {
    Eigen::Index first, size;
    double weight;  // d_b
  };
  struct Power {
    double h;
    Eigen::MatrixXd exponential, integral;
  };

  void weigh();
  std::vector<double> weights(const Eigen::MatrixXd& sizes, double most_coupling) const;
  double rate_of(const Eigen::MatrixXd& sizes, const std::vector<double>& weights) const;
  void square(const stability::twofold::Matrix& a);
  void sum_series(double h, Eigen::Ref<Eigen::VectorXd> x, Eigen::Ref<Eigen::VectorXd> integral) const;

  Eigen::MatrixXd a_;
  std::vector<Part> parts_;
  std::vector<Power> powers_;  // of twice the time each
  double speed_ = 0;
  double rate_ = 0;
  double growth_ = 1;
  bool decays_ = false;
};

}  // namespace breakaway::hybrid
