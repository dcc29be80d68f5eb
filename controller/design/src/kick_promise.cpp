#include "breakaway/design/kick_promise.hpp"

#include <algorithm>
#include <limits>

#include "worst_kicks.hpp"

namespace breakaway::design {
namespace {

constexpr int most_counted = 100000;  // kicks

}  // namespace

template <class Real>
KickPromise::KickPromise(const BrakedClass& axes, const BrakedDesign<Real>& design, double tolerance_m)
    : worst_{design.possible() && tolerance_m >= design.least_tolerance_m * (1 - 1e-9)
                 ? std::make_shared<const detail::WorstKicks>(axes, design.kicks, tolerance_m,
                                                              std::max(design.reach_m, tolerance_m))
                 : nullptr},
      reading_error_m_{axes.reading_error_m()},
      tolerance_m_{tolerance_m} {}

KickPromise::Sequence KickPromise::from(double distance_m) const {
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
