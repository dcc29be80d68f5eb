#include "breakaway/stability/attractivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/input/input_error.hpp"
#include "breakaway/stability/definite_proof.hpp"
#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/mass_units.hpp"
#include "eigencolumns.hpp"
#include "infinite.hpp"
#include "power_proof.hpp"
#include "proved_level.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// lambda^T H lambda / 2 is V at the equilibrium K^-1 W Lambda lambda, |lambda_i| <= 1. With H, the factor that bounds
// what rounding may have kept off it: infinite where K is too nearly singular to say.
struct RestEnergy {
  MatrixXd form;
  double most = infinite;
};

// Of a K with a unit diagonal the factors and the two solutions are those of a K + E with |E| <= (3 n + 2) n u |K|
// (Higham, Accuracy and Stability of Numerical Algorithms, 10.1), so that energies are true to this share of cond(K).
RestEnergy rest_energy(const LinearMachine<>& system) {
  const VectorXd unit = system.stiffness.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd pushes = unit.asDiagonal() * (system.directions * system.friction_N.asDiagonal());
  const dense::Cholesky factors(unit.asDiagonal() * (system.stiffness * unit.asDiagonal()));
  constexpr double unit_roundoff = 0x1p-53;
  const Index m = system.directions.cols();
  if (!factors.succeeded()) return {MatrixXd::Zero(m, m)};
  const auto n = static_cast<double>(unit.size());
  const double share = (3 * n + 2) * n * unit_roundoff / factors.reciprocal_condition();
  return {pushes.transpose() * factors.solve(pushes), share < 1 ? 1 / (1 - share) : infinite};
}

// Largest lambda^T H lambda / 2 over |lambda_i| <= 1, of one friction at least: at a corner, for H is positive
// semidefinite. Goes from corner to corner by one sign at a time (Gray's code).
double greatest_rest_energy_J(const MatrixXd& h) {
  const Index m = h.rows();
  if (m > 20) return 0.5 * h.cwiseAbs().sum();
  VectorXd signs = VectorXd::Ones(m), force = h * signs;
  double greatest = signs.dot(force);
  for (unsigned corner = 1; corner < (1u << (m - 1)); ++corner) {
    const int flipped = __builtin_ctz(corner);
    signs[flipped] = -signs[flipped];
    force += 2 * signs[flipped] * h.col(flipped);
    greatest = std::max(greatest, signs.dot(force));
  }
  return greatest / 2;
}

std::string indefinite(const std::string& name, Proof proof) {
  const std::string remedy = name == "mass" ? "give every coordinate a mass" : "add feedback of position";
  if (proof == Proof::fails) return name + " is not symmetric and positive definite (condition 1); " + remedy;
  return name + " is so nearly singular that rounding hides whether it is positive definite (condition 1); " + remedy;
}

Condition definite_condition(const std::string& name, const MatrixXd& matrix) {
  const Proof proof = positive_definite(matrix);
  const bool holds = proof == Proof::holds;
  const double margin = definiteness(matrix);
  return {"1: " + name + " is symmetric and positive definite", holds,
          holds ? std::max(margin, std::numeric_limits<double>::min()) : std::min(margin, 0.0),
          holds ? "margin: its smallest eigenvalue, scaled to a unit diagonal" : indefinite(name, proof)};
}

// Holds in any case, for the symmetric part; [A] demands a symmetric C.
Condition symmetric_damping(const MatrixXd& damping) {
  const double size = damping.cwiseAbs().maxCoeff();
  const double skew = size == 0 ? 0 : (damping - damping.transpose()).cwiseAbs().maxCoeff() / (2 * size);
  return {"1: damping is symmetric", true, 1 - skew,
          symmetric(damping) ? "margin: 1 less the share of the skew part"
                             : "not symmetric, but the skew part does no work: the symmetric part is certified"};
}

Condition in_span(const Attractivity& a, double outside, bool proved) {
  const std::string name = "2: the eigencolumns of the non-positive eigenvalues of the damping are in span{W}";
  if (!proved) {
    return {name, false, std::min(0.0, -outside),
            "no friction is proved to act against all that the damping does not hold (condition 2), or rounding hides "
            "it; damp it by feedback"};
  }
  if (a.unstable == 0) return {name, true, infinite, "the damping has no non-positive eigenvalue"};
  if (a.alpha < infinite) return {name, true, a.beta, "margin: beta of (9), N/sqrt(kg)"};
  return {name, false, -outside,
          "an eigencolumn of the damping with a non-positive eigenvalue is not in span{W} (condition 2): no friction "
          "acts against it; damp it by feedback"};
}

Condition rests_inside(const Attractivity& a) {
  const double margin = a.rho_star_J == infinite ? 1 : 1 - std::sqrt(a.greatest_rest_J / a.rho_star_J);
  return {"3: E is inside {V < rho*}", a.all_of_E, margin,
          a.all_of_E ? "margin: 1 less the farthest corner of E over the border, in the metric sqrt(V)"
                     : "E reaches out of {V < rho*}: only the part inside is certified; add damping, or stiffness"};
}

// (7): rho_i = beta^2 / (2 lambda_i^2 |e_{n+i}^T S^-1|^2), and |e_{n+i}^T S^-1|^2 is an entry of P^-1, which is
// U_c^T M^-1 U_c there.
double rho_J(double beta, double eigenvalue, double mobility) {
  if (eigenvalue >= 0) return infinite;
  const double speed = beta / eigenvalue;
  return speed * speed / (2 * mobility);
}

// The theorem's level never exceeds the one of energy_level.hpp, which is proved: where rounding has made it larger,
// the proof counts.
void hold_to_the_proof(Attractivity& a) { a.rho_star_J = std::min(a.rho_star_J, a.level_J); }

// Conditions 2 and 3, given condition 1 and a list of corners that is not too long. `system` is in mass units. Returns
// how far the eigencolumns reach out of span W.
double apply_theorem(const LinearMachine<>& system, const SpannedSpace& space, const MatrixXd& pushes,
                     const PowerProof& proof, Attractivity& a) {
  const MatrixXd damping = dense::symmetric_part(system.damping);
  Eigencolumns basis = eigencolumns(damping, proof.definite(), proof.semidefinite());
  a.unstable = (basis.values.array() <= 0).count();
  const MatrixXd inverse_mass = dense::Cholesky(system.mass).inverse();
  const double outside = (space.complement.transpose() * basis.columns.leftCols(a.unstable)).norm();
  const bool spanned = proof.found() && (a.unstable == 0 || outside <= 1e-9);
  if (spanned && a.unstable > 0) {
    // Sum |eta_i| over i <= n_q is convex and h(v) = p^T |W^T v| a support function: their ratio is greatest at a
    // corner.
    const MatrixXd corners = unit_corners(space, pushes);
    turn_for_level(basis, a.unstable, inverse_mass, corners);
    a.alpha = (basis.columns.leftCols(a.unstable).transpose() * corners).cwiseAbs().colwise().sum().maxCoeff();
  }
  if (!spanned) a.alpha = infinite;
  a.beta = 1 / a.alpha;
  a.eigencolumns = basis.columns;
  a.eigenvalues = basis.values;
  if (!spanned) return outside;
  a.certified = true;
  a.rho_J.resize(a.unstable);
  for (Index i = 0; i < a.unstable; ++i) {
    const VectorXd column = basis.columns.col(i);
    a.rho_J[i] = rho_J(a.beta, basis.values[i], column.dot(inverse_mass * column));
  }
  a.rho_star_J = a.unstable == 0 ? infinite : a.rho_J.minCoeff();
  hold_to_the_proof(a);
  a.all_of_E = a.greatest_rest_J < a.rho_star_J;
  return outside;
}

// Returns what keeps V from being defined, or nothing. Condition 1 of the theorem asks whether V is positive.
std::string ill_formed(const LinearMachine<>& system) try {
  require_well_formed(system);
  const char* skew = !symmetric(system.mass) ? "mass" : !symmetric(system.stiffness) ? "stiffness" : nullptr;
  if (skew == nullptr) return {};
  return std::string{skew} + " is not symmetric (condition 1 of Theorem 1); its energy needs a symmetric matrix";
} catch (const InputError& error) {
  return error.what();
}

// From figures of a machine whose forces were divided by `unit`.
void back_to_newtons(Attractivity& a, double unit) {
  a.alpha /= std::sqrt(unit);
  a.beta *= std::sqrt(unit);
  a.rho_J *= unit;
  for (double* const energy_J : {&a.greatest_rest_J, &a.remark_3_J}) *energy_J *= unit;
  // Everywhere is a proof of its own, which no overflow stands for.
  for (double* const level_J : {&a.rho_star_J, &a.level_J}) {
    if (*level_J < infinite) *level_J = std::min(*level_J * unit, std::numeric_limits<double>::max());
  }
}

Attractivity refused(Attractivity a, std::string reason) {
  a.reason = std::move(reason);
  return a;
}

}  // namespace

double Attractivity::certified_share_of_E() const {
  if (greatest_rest_J < level_J || greatest_rest_J == 0) return level_J > 0 ? 1 : 0;
  return std::sqrt(level_J / greatest_rest_J);
}

Attractivity certify_attractivity(const LinearMachine<>& machine) {
  Attractivity a;
  if (const std::string error = ill_formed(machine); !error.empty()) return refused(a, error);
  a.conditions = {definite_condition("mass", machine.mass), definite_condition("stiffness", machine.stiffness),
                  symmetric_damping(machine.damping)};
  for (const Condition& condition : a.conditions) {
    if (!condition.holds) return refused(a, condition.reason);
  }
  const double unit = force_unit(machine.mass);
  const LinearMachine<> divided = in_force_unit(machine, unit), system = in_units(divided, mass_units(divided.mass));
  if (!system.damping.allFinite() || !system.directions.allFinite())
    return refused(a, "the masses differ by more than numbers can hold; use other units of length or mass");
  a.definite = true;
  const bool pushed = !(divided.directions * divided.friction_N.asDiagonal()).isZero(0);
  const RestEnergy rest = rest_energy(divided);
  if (pushed) a.greatest_rest_J = rest.most < infinite ? rest.most * greatest_rest_energy_J(rest.form) : infinite;
  a.remark_3_J = pushed && rest.most == infinite ? infinite : rest.form.sum() / 2;
  const MatrixXd pushes = system.directions * system.friction_N.asDiagonal();
  const SpannedSpace space = spanned_space(pushes);
  if (facet_candidates(space) > most_facet_candidates) {
    back_to_newtons(a, unit);
    return refused(a, "the linear program (9) has more than a million corners; merge frictions");
  }
  const PowerProof proof{divided};
  a.level_J = dissipated_level_J(divided, proof);
  const double outside = apply_theorem(system, space, pushes, proof, a);
  back_to_newtons(a, unit);
  a.conditions.push_back(in_span(a, outside, proof.found()));
  if (!a.certified) return refused(a, a.conditions.back().reason);
  a.conditions.push_back(rests_inside(a));
  return a;
}

std::optional<double> closed_form_rho_J(const LinearMachine<>& s) {
  if (!ill_formed(s).empty() || s.mass.rows() != 2 || s.directions.cols() != 2 || !s.directions.isIdentity(0))
    return std::nullopt;
  const auto &m = s.mass, &c = s.damping;
  if (m(0, 1) != 0 || c(0, 0) != c(1, 1) || c(0, 1) != c(1, 0)) return std::nullopt;
  const double against = c(0, 0) - c(0, 1), together = c(0, 0) + c(0, 1);  // c1 + 2 c2 and c1
  if (!(against < 0 && together > 0)) return std::nullopt;
  const double gamma = -s.friction_N.minCoeff() / against;
  const double reduced_kg = 1 / (1 / m(0, 0) + 1 / m(1, 1));
  return 0.5 * reduced_kg * gamma * gamma;
}

}  // namespace breakaway::stability
