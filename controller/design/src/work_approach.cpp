#include "work_approach.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace breakaway::design {
namespace {

using detail::infinite;
using detail::Jointed;
using std::numbers::pi;

using Complex = std::complex<double>;

struct Sloped {
  Complex value, slope;  // of a function of s
};
Sloped product(const Sloped& a, const Sloped& b) { return {a.value * b.value, a.slope * b.value + a.value * b.slope}; }

// Of a number whose square is not near the ends of the range: std::complex takes ten times as long to allow for those.
Complex one_over(Complex z) { return std::conj(z) / std::norm(z); }

// e^(-s n T), of e^(-s T).
Sloped delay(Complex of_period, int periods, double T) {
  Complex value = 1, base = of_period;
  for (auto n = static_cast<unsigned>(periods); n > 0; n /= 2, base *= base)
    if (n % 2 == 1) value *= base;
  return {value, -(periods * T) * value};
}

// The force of the feedback for each metre of the side that is read, in a motion as e^(s t): a reading is as late as
// the latency and the spans of place and speed make it, and a force is held for a period, behind the current loop.
template <class Real>
Sloped feedback_N_per_m(const BrakedClass& c, const law::ShapedApproach<Real>& a, Complex s) {
  const double T = c.period_s, lag_s = c.lag_s.most, span_s = a.speed_periods * T;
  const auto half_stiffness = static_cast<double>(a.stiffness_N_per_m) / 2;
  const auto damping_per_span = static_cast<double>(a.damping_Ns_per_m) / span_s;
  const Complex z = std::exp(-s * T);
  const Sloped mean = delay(z, a.mean_periods, T), span = delay(z, a.speed_periods, T), period{z, -T * z};
  const Complex place = half_stiffness * (1.0 + mean.value), speed = damping_per_span * (1.0 - span.value);
  const Sloped read{place + speed, half_stiffness * mean.slope - damping_per_span * span.slope};
  const Complex per_s = one_over(s), held = (1.0 - period.value) * per_s / T, followed = one_over(1.0 + s * lag_s);
  const Sloped hold{held, (period.value - held) * per_s}, loop{followed, -lag_s * followed * followed};
  return product(product(read, delay(z, c.latency_periods, T)), product(hold, loop));
}

struct Joint {
  double stiffness_N_per_m, damping_Ns_per_m;
};

// By which share a swing of the joint grows in a radian of it at the worst, whose masses are so many times as heavy.
// The root of the loop is followed from the free swing on, as the feedback grows to what it is: one that is no small
// force beside the spring's shifts the swing, and with it how late a reading is; and one that is limited acts as a
// share of it. To the first order of the feedback it is to be kept as well. What grows is not followed any further.
template <class Real>
double growth_of_swing(const Jointed& axis, const law::ShapedApproach<Real>& a, const Joint& of, double gain,
                       double heavier) {
  constexpr int shares = 8, corrections = 8;
  constexpr double exactly = 1e-24;  // of the root, squared: what rounding leaves is less by far than any growth
  const double m1 = heavier * axis.load.motor_kg, m2 = heavier * axis.load.load_kg, both = m1 + m2;
  const double w = std::sqrt(of.stiffness_N_per_m * (1 / m1 + 1 / m2));
  const auto joint = [&](Complex s) {
    return Sloped{of.damping_Ns_per_m * s + of.stiffness_N_per_m, of.damping_Ns_per_m};
  };
  const auto free = [&](Complex s) {
    const auto [value, slope] = joint(s);
    return product({s * s, 2.0 * s}, {m1 * m2 * s * s + both * value, 2 * m1 * m2 * s + both * slope});
  };
  const double unread = axis.load.encoder_on_load ? 0 : m2;
  const auto fed_back = [&](Complex s) {
    const auto [value, slope] = joint(s);
    return product(feedback_N_per_m(axis.axes, a, s),
                   {gain * (unread * s * s + value), gain * (2 * unread * s + slope)});
  };
  const auto step_to_root = [&](Complex s, double share) {
    const Sloped alone = free(s), fed = fed_back(s);
    return -(alone.value + share * fed.value) * one_over(alone.slope + share * fed.slope);
  };
  Complex root{0, w};
  double growth = -((free(root).value + fed_back(root).value) / free(root).slope).real() / w;
  for (int i = 1; i <= shares && growth <= 0; ++i) {
    const double share = static_cast<double>(i) / shares;
    double off = infinite;
    for (int j = 0; j < corrections && off > exactly * std::norm(root); ++j) {
      const Complex step = step_to_root(root, share);
      root += step;
      off = std::norm(step);
    }
    growth = std::max(growth, root.real() / std::abs(root.imag()));
  }
  return std::isfinite(root.real() / root.imag()) ? growth : infinite;
}

// Which share of a swing's force a spring gives that is loose in the middle, of so many times half of the gap to
// either side: its first harmonic.
double held_share(double halves) {
  const double loose = 1 / halves;
  return 1 - 2 / pi * (std::asin(loose) + loose * std::sqrt(1 - loose * loose));
}
// Of half of the gap, the greatest swing across it that is looked at: a greater one is that of a joint without a gap.
constexpr double most_halves = 1000;

// By which share a swing grows in a radian, at any stiffness of the class, while the joint holds for this share of it.
// It is not looked at further once it grows.
template <class Real>
double worst_growth(const Jointed& axis, const law::ShapedApproach<Real>& a, double held) {
  const Interval gain = axis.axes.force_gain;
  double worst = -infinite;
  for (double stiffer = 1; stiffer <= most_stiffer && worst <= 0; stiffer *= 1.05) {
    const Joint joint{held * stiffer * axis.K, held * axis.load.damping_Ns_per_m};
    worst = std::max({worst, growth_of_swing(axis, a, joint, gain.most, axis.lighter),
                      growth_of_swing(axis, a, joint, gain.least, axis.heavier)});
  }
  return worst;
}

// Of so many times half of the gap. One that is less is of a spring that holds for less of it: the feedback may drive
// it up to the least that falls, as all greater ones do.
template <class Real>
double kept_up_halves(const Jointed& axis, const law::ShapedApproach<Real>& a) {
  double halves = most_halves;
  for (const double step : {1.3, 1.05})
    while (halves > step && worst_growth(axis, a, held_share(halves / step)) <= 0) halves /= step;
  return halves;
}

// The response of a feedback for which a count more or less over the span changes the force by half of what there is at
// most, and by twice the least friction. The approach has the rest: where the limit cuts what counts ask for, their
// mean no longer damps, and friction is to end what counts alone keep up.
double finely_read(const Jointed& axis, int speed_periods) {
  const BrakedClass& c = axis.axes;
  const double count_m_s = 2 * c.reading_error_m() / (speed_periods * c.period_s);
  return std::min(c.max_force_N / 2, 2 * axis.g) / (2 * axis.M * count_m_s);
}

// Feedback over these spans, as fast as lateness, the swing and the encoder allow.
template <class Real>
double set_feedback(const Jointed& axis, int speed_periods, int mean_periods, law::ShapedApproach<Real>& a) {
  const BrakedClass& c = axis.axes;
  const bool on_load = axis.load.encoder_on_load;
  const double w = 2 * pi * axis.load.resonance_Hz();
  const double late_s =
      (c.latency_periods + 1 + std::max(speed_periods, mean_periods) / 2.0) * c.period_s + c.lag_s.most;
  // Above the resonance the motor moves alone.
  const double alone = on_load ? 1 : axis.load.motor_kg / axis.M;
  const double fastest = std::min({0.12 * w, 0.4 * alone / late_s, finely_read(axis, speed_periods)});
  a.speed_periods = static_cast<std::uint8_t>(speed_periods);
  a.mean_periods = static_cast<std::uint8_t>(mean_periods);
  for (double response = fastest;; response *= 0.95) {
    a.stiffness_N_per_m = static_cast<Real>(axis.M * response * response);
    a.damping_Ns_per_m = static_cast<Real>(2 * axis.M * response);
    if (detail::ends_swings(axis, a)) return response;
    if (response < fastest / 20) return 0;
  }
}

// What leads an approach off its plan, by the feedback of its second order, which is damped critically if readings were
// not late: a force D leads it D/k off, and changes its speed by 2/e D/(M w) at most, whenever it begins and ends.
// Mass and gain that are off in the plan's acceleration, whose two parts undo each other, change the speed by no more
// than twice what they are off of the speed that is planned. Once the plan is over, friction alone stops what is left.
struct OffPlan {
  template <class Real>
  OffPlan(const Jointed& axis, const law::ShapedApproach<Real>& a, double gap_swing_m, double max_speed_m_s) {
    const BrakedClass& c = axis.axes;
    const Interval gain = c.force_gain;
    const double k = gain.least * static_cast<double>(a.stiffness_N_per_m), w = std::sqrt(k / axis.M);
    const double planned_m_s2 = std::min(static_cast<double>(a.acceleration_m_s2), max_speed_m_s / c.period_s);
    const double unknown = std::max(gain.most - axis.lighter, axis.heavier - gain.least);
    const double fed_N = static_cast<double>(a.friction_N);
    const double rubbed_N = std::max(gain.most * fed_N - axis.g, axis.B1 + axis.B2 - gain.least * fed_N);
    const double pushed_N = axis.M * planned_m_s2 * unknown, turned_m_s = 2 * unknown * max_speed_m_s;
    const double speed_m_s =
        late * (std::min(2 / std::numbers::e * pushed_N / (axis.M * w), turned_m_s) + rubbed_N / (axis.M * w));
    const double off_m = late * (std::min(pushed_N / k, turned_m_s / w) + rubbed_N / k);
    // While the spring holds what speeds the other side up and rubs there, and swings about that.
    const double swung_N = std::max(axis.load.motor_kg, axis.load.load_kg) * planned_m_s2 + axis.B1 + axis.B2;
    const double swung_m = 2 * swung_N / axis.K + gap_swing_m;
    // Across the gap the force of the plan moves one side alone, and friction takes the work of that from both.
    const double alone_N = axis.M * planned_m_s2 + axis.B1 + axis.B2;
    const double across_m_s = std::sqrt(2 * alone_N * axis.G / std::min(axis.load.motor_kg, axis.load.load_kg));
    beyond_m =
        off_m + (axis.heavier * axis.M * speed_m_s * speed_m_s / 2 + alone_N * axis.G) / axis.g + swung_m + axis.G;
    faster_m_s = late * (speed_m_s + swung_m * 2 * pi * axis.load.resonance_Hz() + across_m_s);
  }

  double beyond_m, faster_m_s;

 private:
  static constexpr double late = 1.5;  // by which it is more where readings are: tested
};

}  // namespace

template <class Real>
double detail::worst_growth_of_swing(const Jointed& axis, const law::ShapedApproach<Real>& a) {
  return worst_growth(axis, a, axis.G > 0 ? held_share(most_halves) : 1);
}

template <class Real>
GapSwing detail::gap_swing(const Jointed& axis, const law::ShapedApproach<Real>& a) {
  if (!(axis.G > 0)) return {};
  const double halves = kept_up_halves(axis, a), swing_m = halves * axis.G / 2;
  const double of_read = (axis.load.encoder_on_load ? axis.load.motor_kg : axis.load.load_kg) / axis.M;
  double most_N_per_m = 0;
  for (double stiffer = 1; stiffer <= most_stiffer; stiffer *= 1.05) {
    const double w = 2 * pi * axis.load.resonance_Hz() * std::sqrt(stiffer * held_share(halves));
    most_N_per_m = std::max(most_N_per_m, std::abs(feedback_N_per_m(axis.axes, a, {0, w}).value));
  }
  return {swing_m, axis.axes.force_gain.most * most_N_per_m * of_read * swing_m};
}

template <class Real>
bool detail::ends_swings(const Jointed& axis, const law::ShapedApproach<Real>& a) {
  return worst_growth_of_swing(axis, a) <= 0 && gap_swing(axis, a).force_N <= axis.g;
}

template <class Real>
law::ShapedApproach<Real> detail::work_approach(const Jointed& axis, int swing_periods) {
  const BrakedClass& c = axis.axes;
  const double A = axis.A1 + axis.A2, B = axis.B1 + axis.B2;
  law::ShapedApproach<Real> a;
  const double sure_N = c.force_gain.least * c.max_force_N - B;
  a.mass_kg = static_cast<Real>(axis.M);
  a.friction_N = static_cast<Real>((A + B) / 2);
  a.acceleration_m_s2 = static_cast<Real>(0.6 * sure_N / (axis.heavier * axis.M));
  a.swing_periods = static_cast<std::uint8_t>(std::min(swing_periods, longest_pulse_periods));
  // Short spans damp a swing that is sampled often; over a whole period of it, it cancels.
  const int n = std::min(swing_periods, static_cast<int>(law::ShapedMove<Real>::most_periods));
  double response = -1;  // of the best so far: the first is taken in any case
  for (const int speed_periods : {std::clamp(n / 8, 1, 8), n / 4, n / 2, n})
    for (const int mean_periods : {0, n / 2}) {
      law::ShapedApproach<Real> tried = a;
      const double found = set_feedback(axis, std::max(speed_periods, 1), mean_periods, tried);
      if (!(found > response)) continue;
      response = found;
      a = tried;
    }
  const double off_m = (B - A) / 2 / static_cast<double>(a.stiffness_N_per_m);
  a.short_of_target_m = static_cast<Real>(off_m);
  a.begin_m = static_cast<Real>(6 * off_m);
  return a;
}

// An axis that breaks away as its friction falls runs ahead of the plan, by up to twice what that changes the balance
// by, and waits until the plan is as far ahead again. The plan has half of what it may have at least.
template <class Real>
double detail::longest_stop_s(const Jointed& axis, const law::ShapedApproach<Real>& a, double max_speed_m_s) {
  const BrakedClass& c = axis.axes;
  const Interval gain = c.force_gain;
  const double k = gain.least * static_cast<double>(a.stiffness_N_per_m), fed_N = static_cast<double>(a.friction_N);
  const double apart_N = axis.B1 + axis.B2 - axis.g + (gain.most - gain.least) * fed_N;
  const double ahead_m = 2 * apart_N / k + axis.unseen_m() + axis.G;
  const double acceleration_m_s2 = static_cast<double>(a.acceleration_m_s2) / 2;
  const double delays = a.swing_periods + std::max(a.mean_periods, a.speed_periods) + c.latency_periods;
  return 2 * ahead_m / max_speed_m_s + std::sqrt(2 * ahead_m / acceleration_m_s2) + delays * c.period_s;
}

template <class Real>
double approach_peak_m_s(const BrakedClass& axes, const WorkDesign<Real>& design, double max_speed_m_s) {
  return max_speed_m_s +
         OffPlan{Jointed{axes}, design.kicks.approach, design.gap_swing.apart_m, max_speed_m_s}.faster_m_s;
}

template <class Real>
double approach_beyond_m(const BrakedClass& axes, const WorkDesign<Real>& design, double max_speed_m_s) {
  return OffPlan{Jointed{axes}, design.kicks.approach, design.gap_swing.apart_m, max_speed_m_s}.beyond_m;
}

template law::ShapedApproach<float> detail::work_approach(const Jointed&, int);
template law::ShapedApproach<double> detail::work_approach(const Jointed&, int);
template double detail::worst_growth_of_swing(const Jointed&, const law::ShapedApproach<float>&);
template double detail::worst_growth_of_swing(const Jointed&, const law::ShapedApproach<double>&);
template bool detail::ends_swings(const Jointed&, const law::ShapedApproach<float>&);
template GapSwing detail::gap_swing(const Jointed&, const law::ShapedApproach<float>&);
template GapSwing detail::gap_swing(const Jointed&, const law::ShapedApproach<double>&);
template double detail::longest_stop_s(const Jointed&, const law::ShapedApproach<float>&, double);
template double detail::longest_stop_s(const Jointed&, const law::ShapedApproach<double>&, double);
template double approach_peak_m_s(const BrakedClass&, const WorkDesign<float>&, double);
template double approach_peak_m_s(const BrakedClass&, const WorkDesign<double>&, double);
template double approach_beyond_m(const BrakedClass&, const WorkDesign<float>&, double);
template double approach_beyond_m(const BrakedClass&, const WorkDesign<double>&, double);

}  // namespace breakaway::design
