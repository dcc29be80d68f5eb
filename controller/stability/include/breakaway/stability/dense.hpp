// Dense linear algebra on matrices whose sizes are known at run time only, compiled once.
//
// Eigen's decompositions are templates, and each of them costs seconds in every file that names it. Whoever needs one
// calls it here; sums and products are cheap and stay in Eigen's notation. Matrices that are not finite give results
// that are not finite, or no result.
#pragma once

#include <Eigen/Core>

namespace breakaway::stability::dense {

// A x = lambda B x. The values ascend; the columns of `vectors` belong to them, with vectors^T B vectors = 1.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

// A must be symmetric; only its lower half is read. B is the identity, or symmetric and positive definite.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// These give the values alone, which takes less time.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// A x = lambda x with unit vectors x; complex values come in conjugate pairs, the positive imaginary part first.
struct GeneralEigen {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

// A must be square.
GeneralEigen general_eigen(const Eigen::MatrixXd& a);

// The largest |A x| over |x| = 1; 0 for an empty matrix.
double spectral_norm(const Eigen::MatrixXd& a);

// The least |A^T x| over |x| = 1: the least singular value of a matrix with no more rows than columns. Rounding adds
// some 1e-16 of the greatest.
double least_singular_value(const Eigen::MatrixXd& a);

// A = L L^T by Cholesky's method, which runs to its end just when A is positive definite to rounding.
class Cholesky {
 public:
  // A must be symmetric; only its lower half is read.
  explicit Cholesky(const Eigen::MatrixXd& a);

  bool succeeded() const { return succeeded_; }
  const Eigen::MatrixXd& lower() const { return lower_; }  // L

  // A^-1, A^-1 right, L^-1 right and L^-T right. They need a decomposition that succeeded.
  Eigen::MatrixXd inverse() const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& right) const;
  Eigen::MatrixXd solve_upper(const Eigen::MatrixXd& right) const;

  // 1 / (|A| |A^-1|) in the 1-norm; needs the same.
  double reciprocal_condition() const;

 private:
  Eigen::MatrixXd lower_;
  bool succeeded_;
};

// Orthonormal bases of what the columns of a matrix span and of what is orthogonal to that: n x r and n x (n - r).
struct Span {
  Eigen::MatrixXd basis, complement;

  Eigen::Index rank() const { return basis.cols(); }
};

// Columns that are shorter than `threshold` of the longest, once the others are taken out of them, count as dependent.
Span span(const Eigen::MatrixXd& columns, double threshold);
Span span(const Eigen::MatrixXd& columns);  // the threshold is rounding

// The unit vector that is orthogonal to n - 1 columns of length n; empty if they are dependent.
Eigen::VectorXd normal(const Eigen::MatrixXd& columns);

// The shortest X that brings A X nearest to `right`: A^-1 right for a regular matrix. Ranks are as in span().
Eigen::MatrixXd solution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& right, double threshold);
Eigen::MatrixXd solution(const Eigen::MatrixXd& a, const Eigen::MatrixXd& right);

// A^-1, whatever the scales of rows and columns are; for a singular matrix its entries are not finite, or huge.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);

// U^T A U.
Eigen::MatrixXd congruence(const Eigen::MatrixXd& u, const Eigen::MatrixXd& a);

// (A + A^T) / 2.
Eigen::MatrixXd symmetric_part(const Eigen::MatrixXd& a);

}  // namespace breakaway::stability::dense
