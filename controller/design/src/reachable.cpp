#include "reachable.hpp"

#include <cmath>
#include <optional>

#include "breakaway/law/kick_judge.hpp"
#include "brief.hpp"
#include "planned_force.hpp"

namespace breakaway::design::detail {
namespace {

// With few digits, to the side that is safe.
double more(double value) { return rounded_up(value, 3); }
double less(double value, int digits = 3) { return rounded_down(value, digits); }

// The coarsest encoder whose readings tell the tolerance, as an end of a sentence; nothing where a float's rounding
// alone hides it. Where noise does, half of what readings may be off is left to it.
std::string take_coarsest_encoder(BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m) {
  const double error_m = tolerance_m * axes.reading_error_m() / design.least_reading_m;
  std::string noise;
  if (!(axes.encoder_noise_m < error_m)) {
    axes.encoder_noise_m = less(error_m / 2);
    if (axes.encoder_noise_m < axes.rounding_m) return {};
    // What a file states is beside the rounding.
    const double stated_m = axes.encoder_noise_m - axes.rounding_m;
    noise = " with an encoder_noise_m of " + brief(stated_m > 0 ? less(stated_m) : 0) + " m";
  }
  const double count_m = less(2 * (error_m - axes.encoder_noise_m));
  if (count_m >= axes.encoder_resolution_m) return "an encoder" + noise;
  // A count is no finer than the float that shows it.
  if (count_m < 2 * axes.rounding_m) return {};
  axes.encoder_resolution_m = count_m;
  return "an encoder_resolution_m of " + brief(count_m) + " m" + noise;
}

bool kicks_are_few(const BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m) {
  const int kicks = most_kicks(axes, design, kicks_begin_m(design), tolerance_m);
  return kicks > 0 && kicks <= law::KickJudge<float>::most_kicks;
}

// What is tried of a class, and what it must keep beside the tolerance.
class Trials {
 public:
  Trials(const Keeps& keeps, double least_period_s) : keeps_{keeps}, least_period_s_{least_period_s} {}

  bool reaches(const BrakedClass& axes, double tolerance_m) const {
    const auto design = design_braked_kicks<float>(axes);
    return design.possible() && design.least_tolerance_m <= tolerance_m && kicks_are_few(axes, design, tolerance_m) &&
           keeps(axes, design);
  }

  // About the longest period, not above that of the class, with which the tolerance can be promised. Of two digits,
  // since drives are told of their period as a whole number up to 255 and a power of ten.
  std::optional<double> longest_period_s(BrakedClass axes, double tolerance_m) const {
    // The ringing on bristles asks for a long period.
    if (axes.presliding_stiffness_N_per_m > 0) return {};
    constexpr double spacing = 0.9;
    constexpr int most_tried = 80;
    axes.fine_tolerance_m = 0;
    for (int i = 0; i < most_tried && axes.jitter_s <= most_jitter * axes.period_s; ++i) {
      axes.period_s = less(axes.period_s, 2);
      if (axes.period_s < least_period_s_ * (1 - 1e-9)) break;
      if (reaches(axes, tolerance_m)) return axes.period_s;
      axes.period_s *= spacing;
    }
    return {};
  }

  // Below the floor the fine stage may aim at a tolerance, where kicks are no list of pulses, and few with its own.
  std::string by_fine_stage(BrakedClass axes, double tolerance_m) const {
    const bool is_asked = axes.fine_tolerance_m > 0;
    axes.fine_tolerance_m = tolerance_m;
    const auto design = design_braked_kicks<float>(axes);
    if (!design.possible() || !design.has_fine_stage() || !kicks_are_few(axes, design, design.least_tolerance_m) ||
        !keeps(axes, design))
      return {};
    return "have the fine stage aim at it and state [run] settle_tolerance_m = " +
           brief(more(error_at_rest_m(axes, design.least_tolerance_m))) + ", within which it ends for certain" +
           (is_asked ? "" : ", without fine_stage = false");
  }

  // With finer steps of force there is a pulse for every distance.
  std::string by_finer_steps(BrakedClass axes, double tolerance_m) const {
    std::string with_fine_stage;
    for (int steps = 65; steps < 10000; steps *= 2) {
      axes.force_step_N = less(axes.max_force_N / steps);
      std::string of = "a drive with steps of force of " + brief(axes.force_step_N) + " N";
      if (reaches(axes, tolerance_m)) return of;
      if (!with_fine_stage.empty()) continue;
      if (const std::string fine = by_fine_stage(axes, tolerance_m); !fine.empty())
        with_fine_stage.append(of).append(" and ").append(fine);
    }
    return with_fine_stage;
  }

 private:
  bool keeps(const BrakedClass& axes, const BrakedDesign<float>& design) const {
    return !keeps_ || keeps_(axes, design);
  }

  const Keeps& keeps_;
  double least_period_s_;
};

// An encoder with what else the tolerance takes; nothing where it takes more than one thing else.
std::string by_encoder(const Trials& trials, const BrakedClass& finer, const std::string& encoder, double tolerance_m) {
  std::string taken = ", or take " + encoder;
  if (trials.reaches(finer, tolerance_m)) return taken;
  std::string ways;
  if (const auto period_s = trials.longest_period_s(finer, tolerance_m))
    ways.append(taken).append(" with a period_s of ").append(brief(*period_s)).append(" s");
  if (const std::string fine = trials.by_fine_stage(finer, tolerance_m); !fine.empty())
    return ways.append(taken).append(" and ").append(fine);
  if (const std::string steps = trials.by_finer_steps(finer, tolerance_m); ways.empty() && !steps.empty())
    ways.append(taken).append(" and ").append(steps);
  return ways;
}

// Where no reading tells the tolerance. The fine stage may still aim at the least one that a reading tells.
std::string ways_to_tell(const Trials& trials, const BrakedClass& axes, const BrakedDesign<float>& design,
                         double tolerance_m) {
  std::string ways;
  const double told_m = more(design.least_reading_m);
  if (const std::string fine = trials.by_fine_stage(axes, told_m); !fine.empty())
    ways = ", or widen it to " + brief(told_m) + " m only and " + fine;
  BrakedClass finer = axes;
  const std::string encoder = take_coarsest_encoder(finer, design, tolerance_m);
  if (encoder.empty())
    return ways + (axes.rounding_m > 0 ? ", or narrow [limits] of position, where the drive's float is finer"
                                       : ", or take an encoder with less noise");
  return ways + by_encoder(trials, finer, encoder, tolerance_m);
}

}  // namespace

double error_at_rest_m(const BrakedClass& axes, double reached_m) {
  const bool bends = axes.presliding_stiffness_N_per_m > 0;
  return reached_m + (bends ? 2 * axes.encoder_resolution_m : axes.reading_error_m());
}

std::string ways_to_reach(const BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m,
                          double least_period_s, const Keeps& keeps) {
  if (!design.possible()) return "mend the other checks first";
  const Trials trials{keeps, least_period_s};
  std::string ways = "widen it to " + brief(more(design.least_tolerance_m)) + " m";
  const bool told = tolerance_m >= design.least_reading_m * (1 - 1e-9);
  if (!told) return ways + ways_to_tell(trials, axes, design, tolerance_m);
  if (const auto period_s = trials.longest_period_s(axes, tolerance_m))
    ways += ", or shorten period_s to " + brief(*period_s) + " s";
  const bool list = design.kicks.table.list;
  const std::string other = list ? trials.by_finer_steps(axes, tolerance_m) : trials.by_fine_stage(axes, tolerance_m);
  return other.empty() ? ways : ways + (list ? ", or take " : ", or ") + other;
}

std::optional<double> longest_lag_s(const BrakedClass& axes, const std::function<bool(const BrakedClass&)>& certified) {
  constexpr double spacing = 0.6, least_periods = 0.01;  // a lag as short as that is none
  constexpr int halvings = 10;
  const double sum_s = axes.lag_s.least + axes.lag_s.most, share = sum_s > 0 ? spread(axes.lag_s) : 0;
  const auto holds = [&](double lag_s) {
    BrakedClass quicker = axes;
    quicker.lag_s = {lag_s * (1 - share), lag_s * (1 + share)};
    return certified(quicker);
  };
  double too_long_s = sum_s / 2, found_s = 0;
  while (too_long_s > least_periods * axes.period_s && found_s == 0) {
    const double lag_s = less(spacing * too_long_s);
    (holds(lag_s) ? found_s : too_long_s) = lag_s;
  }
  if (found_s == 0) return {};
  for (int i = 0; i < halvings; ++i) {
    const double between_s = less((found_s + too_long_s) / 2);
    if (between_s <= found_s) break;
    (holds(between_s) ? found_s : too_long_s) = between_s;
  }
  return found_s;
}

}  // namespace breakaway::design::detail
