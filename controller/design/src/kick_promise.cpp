#include "breakaway/design/kick_promise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/law/fine_stage.hpp"
#include "worst_kicks.hpp"

namespace breakaway::design {
namespace {

constexpr int most_counted = 100000;  // kicks

// Of friction that bends nothing is proved: kicks that begin while the axis still rings may each lead less far. Under
// constant friction the axis 7419 of the campaign took 126 where the worst sequence of kicks from rest has 91.
int more_on_spring(int kicks) { return 2 + kicks / 2; }

}  // namespace

template <class Real>
KickPromise::KickPromise(const BrakedClass& axes, const BrakedDesign<Real>& design, double tolerance_m)
    : reading_error_m_{axes.reading_error_m()},
      tolerance_m_{design.has_fine_stage() ? design.least_tolerance_m : tolerance_m},
      spring_{on_spring(axes, design.kicks, tolerance_m)},
      fine_tolerance_m_{design.has_fine_stage() ? axes.fine_tolerance_m : 0},
      fine_reach_m_{design.has_fine_stage() ? (1 + law::fine_floors_beyond) * design.least_tolerance_m : 0} {
  if (design.possible() && tolerance_m_ >= design.least_tolerance_m * (1 - 1e-9))
    worst_ = std::make_shared<const detail::WorstKicks>(axes, design.kicks, tolerance_m_,
                                                        std::max(design.reach_m, tolerance_m_));
}

// A force that ends in a kick has come to its limit while the axis stood outside the tolerance, and may have been at
// the other one.
template <class Real>
KickPromise::OnSpring KickPromise::on_spring(const BrakedClass& axes, const law::BrakedKicks<Real>& flashed,
                                             double tolerance_m) {
  const law::FrictionSpring<Real>& spring = flashed.spring;
  if (!spring.is_there()) return {};
  const double T = axes.period_s, stays = flashed.either_way_periods + axes.latency_periods;
  const double outside_m = std::max(tolerance_m, axes.encoder_resolution_m / 2);
  const double crossing =
      2 * static_cast<double>(spring.most_N) / (static_cast<double>(spring.gain_N_per_m) * outside_m);
  return {.ringing_s = spring.ringing_periods * T,
          .leading_s = (crossing + stays + 1) * T,
          .holding_s = (spring.longest_periods + spring.ringing_periods + stays) * T,
          .reach_m = static_cast<double>(spring.reach_m)};
}

KickPromise::Sequence KickPromise::from(double distance_m) const {
  Sequence all = kicked_from(distance_m);
  if (all.kicks == 0 || !std::isfinite(all.time_s) || !(spring_.reach_m > 0)) return all;
  const double each_s = all.time_s / all.kicks;
  all.kicks += more_on_spring(all.kicks);
  all.time_s = all.kicks * each_s;
  const int led = fine_tolerance_m_ > 0 ? all.kicks : by_table(std::min(spring_.reach_m, distance_m)).kicks;
  all.time_s += all.kicks * spring_.ringing_s + led * spring_.leading_s + spring_.holding_s;
  return all;
}

KickPromise::Sequence KickPromise::kicked_from(double distance_m) const {
  Sequence all = by_table(distance_m);
  if (!(fine_tolerance_m_ > 0) || !(distance_m + reading_error_m_ > fine_tolerance_m_) || !std::isfinite(all.time_s))
    return all;
  const Sequence back = by_table(fine_reach_m_);
  if (!std::isfinite(back.time_s)) return back;
  all.kicks += law::most_fine_kicks + back.kicks;
  all.time_s += law::most_fine_kicks * worst_->longest_s(fine_reach_m_) + back.time_s;
  return all;
}

KickPromise::Sequence KickPromise::by_table(double distance_m) const {
  constexpr Sequence endless{0, std::numeric_limits<double>::infinity()};
  if (!worst_) return endless;
  Sequence all{0, 0};
  for (double error_m = distance_m; error_m + reading_error_m_ > tolerance_m_;) {
    const double next_m = worst_->after(error_m);
    if (!(next_m < error_m) || ++all.kicks > most_counted) return endless;
    all.time_s += worst_->longest_s(error_m);
    error_m = next_m;
  }
  return all;
}

int KickPromise::most_kicks(double distance_m) const { return from(distance_m).kicks; }
double KickPromise::most_s(double distance_m) const { return from(distance_m).time_s; }

template KickPromise::KickPromise(const BrakedClass&, const BrakedDesign<float>&, double);
template KickPromise::KickPromise(const BrakedClass&, const BrakedDesign<double>&, double);

template <class Real>
int most_kicks(const BrakedClass& axes, const BrakedDesign<Real>& design, double distance_m, double tolerance_m) {
  return KickPromise{axes, design, tolerance_m}.most_kicks(distance_m);
}

template int most_kicks(const BrakedClass&, const BrakedDesign<float>&, double, double);
template int most_kicks(const BrakedClass&, const BrakedDesign<double>&, double, double);

}  // namespace breakaway::design
