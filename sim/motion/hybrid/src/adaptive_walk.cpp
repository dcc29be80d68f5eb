#include "adaptive_walk.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "breakaway/hybrid/lcp.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::hybrid {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Static friction gives way a little above its limit: a push that equals it to rounding would stick and slip for ever.
constexpr double tie = 1e-12;

// A part of a sum of larger terms that is not rounding.
constexpr double significant = 1e-12;

int sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

// The direction in which i would slide if this limit gave way.
int slides(const Facet<Eigen::Dynamic, Eigen::Dynamic>& facet, Limit limit, Index i) {
  return -limit.side * sign(facet.share[i]);
}

}  // namespace

HeldSet make_held_set(const LinearMachine<>& machine, DirectionSet sticking) {
  const StickSet<> stuck = make_stick_set(machine, sticking);
  const Index n = machine.coordinates(), m = machine.frictions();
  const MatrixXd factor = machine.mass.llt().matrixL();
  // In coordinates in which the mass is the identity, what is orthogonal to the sticking directions.
  MatrixXd columns = MatrixXd::Zero(n, m);
  for (Index i = 0; i < m; ++i) {
    if (!contains(stuck.sticking, i)) continue;
    columns.col(i) = factor.triangularView<Eigen::Lower>().solve(machine.directions.col(i)).stableNormalized();
  }
  Index rank = 0;
  MatrixXd all = MatrixXd::Identity(n, n);
  if (stuck.sticking != 0) {
    Eigen::ColPivHouseholderQR<MatrixXd> qr(n, m);
    qr.setThreshold(1e-12);
    qr.compute(columns);
    rank = qr.rank();
    all = qr.householderQ() * all;
  }
  // All columns are solved for, since Eigen cannot solve for none.
  const MatrixXd motions = factor.transpose().triangularView<Eigen::Upper>().solve(all);
  const Index left = n - rank;
  HeldSet held{
      stuck.sticking, motions.rightCols(left), all.rightCols(left).transpose() * factor.transpose(), {}, stuck.facets};
  held.sliding = machine.directions.transpose() * held.basis;
  for (Index i = 0; i < m; ++i) {
    if (contains(held.sticking, i)) held.sliding.row(i).setZero();
  }
  return held;
}

bool AdaptiveWalk::all_stick() const {
  return std::all_of(signs.begin(), signs.end(), [](int sliding) { return sliding == 0; });
}

double AdaptiveWalk::next_change_s() const {
  double next_s = std::numeric_limits<double>::infinity();
  for (const auto& law : laws) next_s = std::min(next_s, law.next_time_change_s());
  return next_s;
}

VectorXd AdaptiveWalk::force(double tau_s, Index exchanged, double speed_m_s) const {
  VectorXd sum = machine.force_N - machine.stiffness * q - machine.damping * v;
  for (Index i = 0; i < machine.frictions(); ++i) {
    const int sliding = signs[static_cast<std::size_t>(i)];
    if (sliding == 0) continue;
    const double speed = i == exchanged ? speed_m_s : sliding * machine.directions.col(i).dot(v);
    const double level_N = laws[static_cast<std::size_t>(i)].level_N(time_after(tau_s), position_m(i), speed);
    sum -= machine.directions.col(i) * (sliding * level_N);
  }
  return sum;
}

double AdaptiveWalk::margin_N(Limit limit, const VectorXd& force, double at_s, bool for_ever) {
  const auto& facet = held->facets[limit.facet];
  double most_N = 0;
  for (Index i = 0; i < machine.frictions(); ++i) {
    if (facet.share[i] == 0) continue;
    auto& law = laws[static_cast<std::size_t>(i)];
    const bool may_fall = for_ever && (law.varies_with_time() || std::isfinite(law.next_time_change_s()));
    most_N += std::abs(facet.share[i]) *
              (may_fall ? law.bounds().lower_N : law.breakaway_N(at_s, position_m(i), slides(facet, limit, i)));
  }
  return most_N * (1 + tie) + limit.side * facet.normal.dot(force);
}

void AdaptiveWalk::pass_time(double duration_s) {
  const double passed_s = duration_s + time_rest_s, sum_s = time_s + passed_s;
  time_rest_s = passed_s - (sum_s - time_s);
  time_s = sum_s;
}

void AdaptiveWalk::face_laws() {
  for (Index i = 0; i < machine.frictions(); ++i) {
    laws[static_cast<std::size_t>(i)].face(position_m(i), signs[static_cast<std::size_t>(i)]);
  }
}

// With a little more than the tie, so that a limit at which another gave way holds until it is left outwards.
bool AdaptiveWalk::holds(bool for_ever) {
  const VectorXd applied = force();
  for (std::size_t k = 0; k < held->facets.size(); ++k) {
    const double rounding_N = 0.1 * tie * std::abs(held->facets[k].normal.dot(applied));
    for (const int side : {-1, 1}) {
      if (margin_N({k, side}, applied, time_after(0), for_ever) < -rounding_N) return false;
    }
  }
  return true;
}

void AdaptiveWalk::choose_mode(DirectionSet stopped) {
  held = &held_set(stopped);
  for (Index i = 0; i < machine.frictions(); ++i) {
    int& sliding = signs[static_cast<std::size_t>(i)];
    if (!contains(held->sticking, i) || sliding == 0) continue;
    sliding = 0;
    laws[static_cast<std::size_t>(i)].on_stick(time_after(0));
  }
  face_laws();
  if (!holds()) {
    held = &held_set(held->sticking & ~release(held->sticking, 0));
    face_laws();
  }
  if (held->sticking != 0) v = held->basis * (held->to_reduced * v);
}

void AdaptiveWalk::give_way(Limit limit) {
  const auto& facet = held->facets[limit.facet];
  DirectionSet stopped = held->sticking, told = 0;
  for (Index i = 0; i < machine.frictions(); ++i) {
    if (facet.share[i] == 0) continue;
    auto& law = laws[static_cast<std::size_t>(i)];
    const int direction = slides(facet, limit, i);
    const double before_N = law.breakaway_N(time_after(0), position_m(i), direction);
    law.on_slip(time_after(0));
    law.face(position_m(i), direction);
    told |= only(i);
    // A law that is drawn anew at the slip may hold after all.
    if (law.level_N(time_after(0), position_m(i), 0) > before_N) continue;
    signs[static_cast<std::size_t>(i)] = direction;
    stopped &= ~only(i);
  }
  held = &held_set(stopped);
  face_laws();
  if (!holds()) {
    held = &held_set(stopped & ~release(stopped, told));
    face_laws();
  }
}

// The accelerations at a stop: gamma = A lambda + b with lambda_i in [-f_i(+), f_i(-)], at its ends while sliding. With
// lambda = f(+) (z1 - 1), gamma = w1 - z2 and w2 = f(-) / f(+) + 1 - z1 this is a linear complementarity problem of
// twice the size. A direction that slides has its sliding level instead of its static one, which may bring others to
// slide: they are added until no more do, so that what sticks keeps its static limit. `told`: the laws that know of
// their slip.
DirectionSet AdaptiveWalk::release(DirectionSet stopped, DirectionSet told) {
  std::vector<Index> index;
  for (Index i = 0; i < machine.frictions(); ++i) {
    if (contains(stopped, i)) index.push_back(i);
  }
  const auto count = static_cast<Index>(index.size());
  const auto solver = machine.mass.llt();
  const VectorXd free = solver.solve(force());
  const MatrixXd directions = machine.directions(Eigen::all, index);
  const MatrixXd delassus = directions.transpose() * solver.solve(directions);
  const auto level_N = [&](Index i, int direction) {
    auto& law = laws[static_cast<std::size_t>(i)];
    if (!contains(told, i)) return law.breakaway_N(time_after(0), position_m(i), direction);
    law.face(position_m(i), direction);
    return law.level_N(time_after(0), position_m(i), 0);
  };
  for (;;) {
    LcpMatrix<Eigen::Dynamic> a = MatrixXd::Zero(2 * count, 2 * count);
    LcpVector<Eigen::Dynamic> b(2 * count);
    VectorXd forward_N(count), ratio(count);
    for (Index r = 0; r < count; ++r) {
      forward_N[r] = level_N(index[static_cast<std::size_t>(r)], 1);
      ratio[r] = level_N(index[static_cast<std::size_t>(r)], -1) / forward_N[r];
    }
    for (Index r = 0; r < count; ++r) {
      const double weight = 1 / (delassus(r, r) * forward_N[r]);
      a.row(r).head(count) = weight * delassus.row(r).cwiseProduct(forward_N.transpose());
      b[r] = weight * directions.col(r).dot(free) - a.row(r).head(count).sum();
      a(r, count + r) = 1;
      a(count + r, r) = -1;
      b[count + r] = 1 + ratio[r];
    }
    const auto z = solve_lcp<Eigen::Dynamic>(a, b);
    if (!z) {
      throw InputError{"the friction forces at a stop could not be found: directions and mass are too ill-scaled"};
    }
    DirectionSet released = 0;
    for (Index r = 0; r < count; ++r) {
      const double slide = a.row(r).head(count).dot(z->head(count)) + b[r];
      const double scale = a.row(r).head(count).cwiseAbs().sum() + std::abs(b[r]);
      const Index i = index[static_cast<std::size_t>(r)];
      signs[static_cast<std::size_t>(i)] = std::abs(slide) <= significant * scale ? 0 : sign(slide);
      if (signs[static_cast<std::size_t>(i)] != 0) released |= only(i);
    }
    const DirectionSet fresh = released & ~told;
    if (fresh == 0) return released;
    for (const Index i : index) {
      if (contains(fresh, i)) laws[static_cast<std::size_t>(i)].on_slip(time_after(0));
    }
    told |= fresh;
  }
}

}  // namespace breakaway::hybrid
