#include "breakaway/design/attractivity.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "zonotope.hpp"

namespace breakaway::design {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

bool positive_definite(const Eigen::MatrixXd& matrix) {
  const double size = matrix.cwiseAbs().maxCoeff();
  return (matrix - matrix.transpose()).cwiseAbs().maxCoeff() <= 1e-14 * size &&
         Eigen::LLT<Eigen::MatrixXd>(matrix).info() == Eigen::Success;
}

// Largest lambda^T H lambda / 2 over |lambda_i| <= p_i: at a corner, for H is positive semidefinite. Goes from corner
// to corner by one sign at a time (Gray's code).
double greatest_rest_energy_J(const LinearSystem& system) {
  const Eigen::MatrixXd pushes = system.directions * system.friction_N.asDiagonal();
  const Eigen::MatrixXd h = pushes.transpose() * system.stiffness.llt().solve(pushes);
  const Eigen::Index m = h.rows();
  if (m > 20) return 0.5 * h.cwiseAbs().sum();
  if (m == 0) return 0;
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(m), force = h * signs;
  double greatest = signs.dot(force);
  for (unsigned corner = 1; corner < (1u << (m - 1)); ++corner) {
    const int flipped = __builtin_ctz(corner);
    signs[flipped] = -signs[flipped];
    force += 2 * signs[flipped] * h.col(flipped);
    greatest = std::max(greatest, signs.dot(force));
  }
  return greatest / 2;
}

// The smallest alpha of (9): sum |eta_i| over i <= n_q is convex and h(eta) = p^T |W^T U_c eta| is the support function
// of a zonotope, so their greatest ratio is at one of its facet directions. Infinite when (14) fails.
double smallest_alpha(const Eigen::MatrixXd& pushes, Eigen::Index unstable) {
  const SpannedSpace space = spanned_space(pushes);
  if (space.complement.cols() > 0 && space.complement.topRows(unstable).cwiseAbs().maxCoeff() > 1e-9) return infinite;
  double alpha = 0;
  facet_directions(space, [&](const Eigen::VectorXd& eta) {
    alpha = std::max(alpha, eta.head(unstable).cwiseAbs().sum() / (eta.transpose() * pushes).cwiseAbs().sum());
  });
  return alpha;
}

// (7): rho_i = beta^2 / (2 lambda_i^2 |e_{n+i}^T S^-1|^2), and |e_{n+i}^T S^-1|^2 is an entry of P^-1, which is
// U_c^T M^-1 U_c there.
double rho_J(double beta, double eigenvalue, const Eigen::VectorXd& eigencolumn, const Eigen::MatrixXd& mass) {
  if (eigenvalue >= 0) return infinite;
  const double speed = beta / eigenvalue;
  return speed * speed / (2 * eigencolumn.dot(mass.llt().solve(eigencolumn)));
}

}  // namespace

Attractivity certify_attractivity(const LinearSystem& system) {
  Attractivity a;
  if (!positive_definite(system.mass) || !positive_definite(system.stiffness)) {
    const char* name = positive_definite(system.mass) ? "stiffness" : "mass";
    a.reason = std::string{name} + " is not symmetric and positive definite (condition 1); add feedback of position";
    return a;
  }
  const Eigen::MatrixXd damping = (system.damping + system.damping.transpose()) / 2;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(damping);
  a.eigencolumns = eigen.eigenvectors();
  a.eigenvalues = eigen.eigenvalues();
  const double zero = 1e-15 * static_cast<double>(damping.rows()) * damping.norm();
  for (double& value : a.eigenvalues) value = std::abs(value) <= zero ? 0.0 : value;
  a.unstable = (a.eigenvalues.array() <= 0).count();
  a.greatest_rest_J = greatest_rest_energy_J(system);

  const Eigen::MatrixXd pushes = a.eigencolumns.transpose() * system.directions * system.friction_N.asDiagonal();
  if (facet_candidates(spanned_space(pushes)) > most_facet_candidates) {
    a.reason = "the linear program (9) has more than a million corners; merge frictions";
    return a;
  }
  a.alpha = a.unstable == 0 ? 0.0 : smallest_alpha(pushes, a.unstable);
  a.beta = 1 / a.alpha;
  if (a.alpha == infinite) {
    a.reason =
        "an eigencolumn of the damping with a non-positive eigenvalue is not in span{W} (condition 2): no friction "
        "acts against it; damp it by feedback";
    return a;
  }
  a.rho_J.resize(a.unstable);
  for (Eigen::Index i = 0; i < a.unstable; ++i) {
    a.rho_J[i] = rho_J(a.beta, a.eigenvalues[i], a.eigencolumns.col(i), system.mass);
  }
  a.rho_star_J = a.unstable == 0 ? infinite : a.rho_J.minCoeff();
  a.certified = true;
  a.all_of_E = a.greatest_rest_J < a.rho_star_J;
  return a;
}

}  // namespace breakaway::design
