#include "reachable.hpp"

#include <cmath>
#include <optional>

#include "breakaway/law/kick_judge.hpp"
#include "brief.hpp"

namespace breakaway::design::detail {
namespace {

// With few digits, to the side that is safe.
double more(double value) { return rounded_up(value, 3); }
double less(double value, int digits = 3) { return rounded_down(value, digits); }

// The coarsest encoder whose readings tell the tolerance; none where noise alone hides it.
std::optional<double> coarsest_count_m(const BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m) {
  const double per_error = design.least_reading_m / axes.reading_error_m();
  const double count_m = 2 * (tolerance_m / per_error - axes.encoder_noise_m);
  return count_m > 0 ? std::optional{less(count_m)} : std::nullopt;
}

bool kicks_are_few(const BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m) {
  const int kicks = most_kicks(axes, design, kicks_begin_m(design), tolerance_m);
  return kicks > 0 && kicks <= law::KickJudge<float>::most_kicks;
}

bool reaches(const BrakedClass& axes, double tolerance_m) {
  const auto design = design_braked_kicks<float>(axes);
  return design.possible() && design.least_tolerance_m <= tolerance_m && kicks_are_few(axes, design, tolerance_m);
}

// About the longest period, not above that of the class, with which the tolerance can be promised. Of two digits, since
// drives are told of their period as a whole number up to 255 and a power of ten.
std::optional<double> longest_period_s(BrakedClass axes, double tolerance_m, double least_period_s) {
  constexpr double spacing = 0.9;
  constexpr int most_tried = 80;
  axes.fine_tolerance_m = 0;
  for (int i = 0; i < most_tried && axes.jitter_s <= most_jitter * axes.period_s; ++i) {
    axes.period_s = less(axes.period_s, 2);
    if (axes.period_s < least_period_s * (1 - 1e-9)) break;
    if (reaches(axes, tolerance_m)) return axes.period_s;
    axes.period_s *= spacing;
  }
  return {};
}

// Below the floor the fine stage may aim at a tolerance, where kicks are no list of pulses, and few with its own.
std::string by_fine_stage(BrakedClass axes, double tolerance_m) {
  const bool is_asked = axes.fine_tolerance_m > 0;
  axes.fine_tolerance_m = tolerance_m;
  const auto design = design_braked_kicks<float>(axes);
  if (!design.possible() || design.kicks.table.list || !kicks_are_few(axes, design, design.least_tolerance_m))
    return {};
  return "have the fine stage aim at it and state [run] settle_tolerance_m = " +
         brief(more(error_at_rest_m(axes, design.least_tolerance_m))) + ", within which it ends for certain" +
         (is_asked ? "" : ", without fine_stage = false");
}

// With finer steps of force there is a pulse for every distance.
std::string by_finer_steps(BrakedClass axes, double tolerance_m) {
  const std::string drive = ", or take a drive with steps of force of ";
  std::string with_fine_stage;
  for (int steps = 65; steps < 10000; steps *= 2) {
    axes.force_step_N = less(axes.max_force_N / steps);
    std::string of = drive + brief(axes.force_step_N) + " N";
    if (reaches(axes, tolerance_m)) return of;
    if (!with_fine_stage.empty()) continue;
    if (const std::string fine = by_fine_stage(axes, tolerance_m); !fine.empty())
      with_fine_stage.append(of).append(", ").append(fine);
  }
  return with_fine_stage;
}

}  // namespace

double error_at_rest_m(const BrakedClass& axes, double reached_m) {
  const bool bends = axes.presliding_stiffness_N_per_m > 0;
  return reached_m + (bends ? 2 * axes.encoder_resolution_m : axes.reading_error_m());
}

std::string ways_to_reach(const BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m,
                          double least_period_s) {
  if (!design.possible()) return "mend the other checks first";
  std::string ways = "widen it to " + brief(more(design.least_tolerance_m)) + " m";
  BrakedClass finer = axes;
  const bool told = tolerance_m >= design.least_reading_m * (1 - 1e-9);
  if (!told) {
    const auto count_m = coarsest_count_m(axes, design, tolerance_m);
    if (!count_m) return ways + ", or take an encoder with less noise";
    finer.encoder_resolution_m = *count_m;
  }
  // The ringing on bristles asks for a long period.
  const bool bends = axes.presliding_stiffness_N_per_m > 0;
  const auto period_s = bends ? std::nullopt : longest_period_s(finer, tolerance_m, least_period_s);
  if (!told) {
    const std::string encoder = ", or take an encoder_resolution_m of " + brief(finer.encoder_resolution_m) + " m";
    if (period_s) return ways + encoder + " with a period_s of " + brief(*period_s) + " s";
    return reaches(finer, tolerance_m) ? ways + encoder : ways;
  }
  if (period_s) ways += ", or shorten period_s to " + brief(*period_s) + " s";
  if (design.kicks.table.list) return ways + by_finer_steps(axes, tolerance_m);
  const std::string fine = by_fine_stage(axes, tolerance_m);
  return ways + (fine.empty() ? fine : ", or " + fine);
}

}  // namespace breakaway::design::detail
