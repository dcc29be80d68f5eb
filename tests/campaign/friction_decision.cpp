#include "friction_decision.hpp"

#include <algorithm>
#include <limits>

namespace breakaway::campaign {
namespace {

constexpr int derivatives = 6;  // of the acceleration, before a tie is taken to last

constexpr double infinite = std::numeric_limits<double>::infinity();

// The least of |force + sum lambda_i columns_i| over lower <= lambda <= upper, which may be infinite.
template <class Real>
struct Projection {
  Vector<Real> lambda, residual;
  bool solved = false;
};

// Finds it by its working set (Stark & Parker, Bounded-variable least squares).
template <class Real>
class BoundedLeastSquares {
 public:
  BoundedLeastSquares(const std::vector<Vector<Real>>& columns, const Vector<Real>& force, const Vector<Real>& lower,
                      const Vector<Real>& upper)
      : columns_{columns}, force_{force}, lower_{lower}, upper_{upper}, lambda_(columns.size()), residual_{force} {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      lambda_[i] = std::min(std::max(Real(0), lower[i]), upper[i]);
      scale_ = larger(scale_, norm(columns[i]));
    }
    scale_ += norm(force);
    update_residual();
  }

  Projection<Real> run() {
    for (int iteration = 0; iteration < 400; ++iteration) {
      const std::ptrdiff_t enters = most_violating(iteration > 200);
      if (enters < 0) return {lambda_, residual_, true};
      free_.push_back(static_cast<std::size_t>(enters));
      while (!step_to_least_squares()) {
      }
      update_residual();
    }
    return {};
  }

 private:
  void update_residual() {
    residual_ = force_;
    for (std::size_t i = 0; i < columns_.size(); ++i) add_scaled(residual_, lambda_[i], columns_[i]);
  }

  // The variable that would lower the residual most, or the first one that does.
  std::ptrdiff_t most_violating(bool first) const {
    Real worst = Real(Rounding<Real>::noise) * scale_;
    std::ptrdiff_t found = -1;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (std::find(free_.begin(), free_.end(), i) != free_.end()) continue;
      const Real size = norm(columns_[i]), slope = size > 0 ? dot(columns_[i], residual_) / size : Real(0);
      if (slope > 0 ? lambda_[i] <= lower_[i] : lambda_[i] >= upper_[i]) continue;
      if (magnitude(slope) <= worst) continue;
      found = static_cast<std::ptrdiff_t>(i);
      if (first) break;
      worst = magnitude(slope);
    }
    return found;
  }

  // Solves for the free variables by an orthonormal basis of their columns, and returns their change.
  Vector<Real> free_change() const {
    std::vector<Vector<Real>> basis;
    const std::size_t count = free_.size();
    Matrix<Real> triangle(count, count);
    for (std::size_t j = 0; j < count; ++j) {
      Vector<Real> column = columns_[free_[j]];
      for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t k = 0; k < basis.size(); ++k) {
          const Real share = dot(basis[k], column);
          triangle(k, j) += share;
          add_scaled(column, -share, basis[k]);
        }
      }
      const Real size = norm(column);
      triangle(j, j) = size;
      for (Real& x : column) x = size > 0 ? x / size : Real(0);
      basis.push_back(column);
    }
    Vector<Real> change(count);
    for (std::size_t j = count; j-- > 0;) {
      Real sum = -dot(basis[j], residual_);
      for (std::size_t k = j + 1; k < count; ++k) sum -= triangle(j, k) * change[k];
      change[j] = triangle(j, j) > 0 ? sum / triangle(j, j) : Real(0);
    }
    return change;
  }

  // Goes to the least squares of the free variables, or to the first bound on the way; says whether it got there.
  bool step_to_least_squares() {
    const Vector<Real> change = free_change();
    Real share = 1;
    std::size_t blocking = free_.size();
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const std::size_t i = free_[k];
      const Real room = change[k] > 0 ? upper_[i] - lambda_[i] : lower_[i] - lambda_[i];
      if (change[k] == 0 || magnitude(room) >= share * magnitude(change[k])) continue;
      share = larger(Real(0), room / change[k]);
      blocking = k;
    }
    for (std::size_t k = 0; k < free_.size(); ++k) lambda_[free_[k]] += share * change[k];
    const bool done = blocking == free_.size();
    if (!done) {
      const std::size_t i = free_[blocking];
      lambda_[i] = change[blocking] > 0 ? upper_[i] : lower_[i];
      free_.erase(free_.begin() + static_cast<std::ptrdiff_t>(blocking));
    }
    update_residual();
    return done;
  }

  const std::vector<Vector<Real>>& columns_;
  const Vector<Real>&force_, &lower_, &upper_;
  Vector<Real> lambda_, residual_;
  std::vector<std::size_t> free_;
  Real scale_ = 0;
};

// The directions without acceleration so far, and the interval in which friction, or its change, can lie in each.
template <class Real>
struct Undecided {
  std::vector<std::size_t> index;
  Vector<Real> lower, upper;

  void add(std::size_t direction, Real least, Real most) {
    index.push_back(direction);
    lower.push_back(least);
    upper.push_back(most);
  }
};

template <class Real>
std::vector<Vector<Real>> chosen(const std::vector<Vector<Real>>& from, const std::vector<std::size_t>& index) {
  std::vector<Vector<Real>> result;
  result.reserve(index.size());
  for (const std::size_t i : index) result.push_back(from[i]);
  return result;
}

// What begins to slide gets its sign; the rest is returned with the cone of the changes that friction can still make.
template <class Real>
Undecided<Real> decided(const Undecided<Real>& before, const Projection<Real>& found,
                        const std::vector<Vector<Real>>& pushes, Real threshold, std::vector<int>& signs) {
  Undecided<Real> left;
  for (std::size_t k = 0; k < before.index.size(); ++k) {
    const Real speed = dot(pushes[k], found.residual);
    if (magnitude(speed) > threshold * norm(pushes[k])) {
      signs[before.index[k]] = speed > 0 ? 1 : -1;
      continue;
    }
    const bool at_lower = found.lambda[k] - before.lower[k] <= Real(Rounding<Real>::noise);
    const bool at_upper = before.upper[k] - found.lambda[k] <= Real(Rounding<Real>::noise);
    left.add(before.index[k], at_lower ? Real(0) : -infinite, at_upper ? Real(0) : infinite);
  }
  return left;
}

}  // namespace

template <class Real>
bool decide_friction(const NormalMachine<Real>& machine, const Vector<Real>& q, const Vector<Real>& v,
                     const std::vector<bool>& stopped, std::vector<int>& signs) {
  Undecided<Real> undecided;
  Vector<Real> applied = machine.force;
  Real terms = norm(machine.force), threshold = 0;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    terms += norm(machine.pushes[i]);
    if (!stopped[i]) {
      add_scaled(applied, -signs[i], machine.pushes[i]);
      continue;
    }
    signs[i] = 0;
    undecided.add(i, -1, 1);
  }
  // Derivatives of the coordinates: x and x', then x' and x'', ...
  Vector<Real> below = q, above = v;
  for (int level = 0; level < derivatives && !undecided.index.empty(); ++level) {
    const Vector<Real> spring = machine.stiffness * below, damper = machine.damping * above;
    Vector<Real> balance = level == 0 ? applied : Vector<Real>(q.size());
    add_scaled(balance, -1, spring);
    add_scaled(balance, -1, damper);
    terms = (level == 0 ? terms : Real(0)) + norm(spring) + norm(damper);
    threshold = larger(Real(Rounding<Real>::noise) * terms, machine.rate * threshold);
    const std::vector<Vector<Real>> pushes = chosen(machine.pushes, undecided.index);
    const Projection<Real> found = BoundedLeastSquares<Real>{pushes, balance, undecided.lower, undecided.upper}.run();
    if (!found.solved) return false;
    undecided = decided(undecided, found, pushes, 10 * threshold, signs);
    below = above;
    above = found.residual;
  }
  return true;
}

template bool decide_friction(const NormalMachine<Fast>&, const Vector<Fast>&, const Vector<Fast>&,
                              const std::vector<bool>&, std::vector<int>&);
template bool decide_friction(const NormalMachine<Quad>&, const Vector<Quad>&, const Vector<Quad>&,
                              const std::vector<bool>&, std::vector<int>&);

}  // namespace breakaway::campaign
