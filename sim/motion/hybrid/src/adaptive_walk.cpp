#include "adaptive_walk.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/motion/tie.hpp"
#include "breakaway/stability/extended.hpp"

namespace breakaway::hybrid {
namespace {

namespace extended = stability::extended;
using Eigen::Index;
using Eigen::VectorXd;

int sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

// The direction in which i would slide if this limit gave way.
int slides(const Facet<Eigen::Dynamic, Eigen::Dynamic>& facet, Limit limit, Index i) {
  return -limit.side * sign(facet.share[i]);
}

}  // namespace

// The speed of a direction that is nearly parallel to a sticking one is a small difference: bases are found in extended
// precision, as those of StickSet are.
HeldSet make_held_set(const LinearMachine<>& machine, DirectionSet sticking) {
  const StickSet<> stuck = make_stick_set(machine, sticking);
  const Index n = machine.coordinates(), m = machine.frictions();
  const extended::Matrix mass = machine.mass.cast<long double>(), directions = machine.directions.cast<long double>();
  const extended::Matrix inverse_factor = extended::inverse_cholesky_factor(mass);
  // The motions that are left are orthogonal to the sticking directions, in coordinates in which the mass is 1.
  extended::Matrix columns = inverse_factor * directions;
  for (Index i = 0; i < m; ++i) {
    columns.col(i).stableNormalize();
    if (!contains(stuck.sticking, i)) columns.col(i).setZero();
  }
  const extended::Matrix left =
      stuck.sticking == 0 ? extended::Matrix::Identity(n, n) : extended::span(columns, rank_threshold).complement;
  const extended::Matrix basis = in_coordinates(inverse_factor, left, 1e-17);
  HeldSet held{stuck.sticking, basis.cast<double>(), (basis.transpose() * mass).cast<double>(), {}, stuck.facets};
  held.sliding = (directions.transpose() * basis).cast<double>();
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
  return applied(tau_s, exchanged, speed_m_s) - machine.stiffness * q - machine.damping * v;
}

VectorXd AdaptiveWalk::applied(double tau_s, Index exchanged, double speed_m_s) const {
  VectorXd sum = machine.force_N;
  for (Index i = 0; i < machine.frictions(); ++i) {
    const int sliding = signs[static_cast<std::size_t>(i)];
    if (sliding == 0) continue;
    const double speed = i == exchanged ? speed_m_s : sliding * machine.directions.col(i).dot(v);
    const double level_N = laws[static_cast<std::size_t>(i)].level_N(time.after(tau_s), position_m(i), speed);
    sum -= machine.directions.col(i) * (sliding * level_N);
  }
  return sum;
}

VectorXd AdaptiveWalk::force_rounding() const {
  VectorXd terms = machine.force_N.cwiseAbs() + machine.stiffness.cwiseAbs() * q.cwiseAbs() +
                   machine.damping.cwiseAbs() * v.cwiseAbs();
  for (Index i = 0; i < machine.frictions(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (signs[at] != 0) terms += machine.directions.col(i).cwiseAbs() * laws[at].bounds().upper_N;
  }
  return 8 * std::numeric_limits<double>::epsilon() * terms;
}

double AdaptiveWalk::margin_N(Limit limit, const VectorXd& force, double time_s, bool for_ever) {
  const auto& facet = held->facets[limit.facet];
  double most_N = 0;
  for (Index i = 0; i < machine.frictions(); ++i) {
    if (facet.share[i] == 0) continue;
    auto& law = laws[static_cast<std::size_t>(i)];
    const bool may_fall = for_ever && (law.varies_with_time() || std::isfinite(law.next_time_change_s()));
    most_N += std::abs(facet.share[i]) *
              (may_fall ? law.bounds().lower_N : law.breakaway_N(time_s, position_m(i), slides(facet, limit, i)));
  }
  return motion::widened(most_N) + limit.side * facet.normal.dot(force);
}

void AdaptiveWalk::face_laws() {
  for (Index i = 0; i < machine.frictions(); ++i) {
    laws[static_cast<std::size_t>(i)].face(position_m(i), signs[static_cast<std::size_t>(i)]);
  }
}

// It asks for a little more than the tie, so that a limit at which another gave way holds until it is left outwards.
bool AdaptiveWalk::holds(bool for_ever) {
  const VectorXd applied = force();
  for (std::size_t k = 0; k < held->facets.size(); ++k) {
    const double rounding_N = 0.1 * motion::tie * std::abs(held->facets[k].normal.dot(applied));
    for (const int side : {-1, 1}) {
      if (margin_N({k, side}, applied, time.after(0), for_ever) < -rounding_N) return false;
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
    laws[static_cast<std::size_t>(i)].on_stick(time.after(0));
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
    const double before_N = law.breakaway_N(time.after(0), position_m(i), direction);
    law.on_slip(time.after(0));
    law.face(position_m(i), direction);
    told |= only(i);
    // A law that is drawn anew at the slip may hold after all.
    if (law.level_N(time.after(0), position_m(i), 0) > before_N) continue;
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

// A direction that slides has its sliding level instead of its static one, which may bring others to slide: they are
// added until no more do, so that what sticks keeps its static limit. `told`: the laws that know of their slip.
DirectionSet AdaptiveWalk::release(DirectionSet stopped, DirectionSet told) {
  const VectorXd rounding = force_rounding();
  ModeChoice::Stop stop{time.after(0),
                        q.cast<Extended>(),
                        v.cast<Extended>(),
                        applied().cast<Extended>(),
                        rounding,
                        rounding,
                        {},
                        {},
                        {}};
  for (Index i = 0; i < machine.frictions(); ++i) {
    if (contains(stopped, i)) stop.stopped.push_back(i);
  }
  for (;;) {
    ask_for_levels(stop, told);
    const Sliding sliding = choice.sliding(stop);
    DirectionSet released = slide(stop, sliding, sliding.ties);
    if (sliding.ties != 0) {
      held = &held_set(stopped & ~released);
      if (!holds()) released = slide(stop, sliding, 0);
    }
    const DirectionSet fresh = released & ~told;
    if (fresh == 0) return released;
    for (const Index i : stop.stopped) {
      if (contains(fresh, i)) laws[static_cast<std::size_t>(i)].on_slip(time.after(0));
    }
    told |= fresh;
  }
}

// Lets slide what does, but for those at the places `except`.
DirectionSet AdaptiveWalk::slide(const ModeChoice::Stop& stop, const Sliding& sliding, DirectionSet except) {
  DirectionSet released = 0;
  for (std::size_t r = 0; r < stop.stopped.size(); ++r) {
    const auto place = static_cast<Index>(r);
    const int direction = contains(except, place) ? 0 : sign(sliding.signs[place]);
    signs[static_cast<std::size_t>(stop.stopped[r])] = direction;
    if (direction != 0) released |= only(stop.stopped[r]);
  }
  return released;
}

// The friction of each of the directions in either sense: of those that are told of their slip the sliding level.
void AdaptiveWalk::ask_for_levels(ModeChoice::Stop& stop, DirectionSet told) {
  const auto level_N = [&](Index i, int direction) {
    auto& law = laws[static_cast<std::size_t>(i)];
    if (!contains(told, i)) return law.breakaway_N(time.after(0), position_m(i), direction);
    law.face(position_m(i), direction);
    return law.level_N(time.after(0), position_m(i), 0);
  };
  const auto count = static_cast<Index>(stop.stopped.size());
  stop.forward_N.resize(count);
  stop.backward_N.resize(count);
  for (Index r = 0; r < count; ++r) {
    stop.forward_N[r] = level_N(stop.stopped[static_cast<std::size_t>(r)], 1);
    stop.backward_N[r] = level_N(stop.stopped[static_cast<std::size_t>(r)], -1);
  }
}

}  // namespace breakaway::hybrid
