#include "breakaway/design/work_kicks.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>

#include "breakaway/design/pulse_work.hpp"
#include "breakaway/law/shaped_move.hpp"
#include "work_trial.hpp"

namespace breakaway::design {
namespace {

using std::numbers::pi;

constexpr double sure_share = 1.002;  // by which a pulse exceeds what it has to
constexpr double more_periods = 8;    // in which a swing may show the same count by chance
constexpr double counts_to_leave_hold = 1.5;
constexpr double least_counts = 0.51;
constexpr double infinite = std::numeric_limits<double>::infinity();

// The class with its worst masses and forces.
struct Jointed {
  explicit Jointed(const BrakedClass& c)
      : axes{c},
        load{*c.spring_load},
        K{load.stiffness_N_per_m},
        G{load.gap_m},
        M{load.motor_kg + load.load_kg},
        heavier{2 * c.mass_kg.most / (c.mass_kg.least + c.mass_kg.most)},
        lighter{2 * c.mass_kg.least / (c.mass_kg.least + c.mass_kg.most)},
        A1{load.motor_friction.lower_N - c.load_N},
        A2{load.load_friction.lower_N},
        B1{load.motor_friction.upper_N + c.load_N},
        B2{load.load_friction.upper_N},
        Bs{std::min(B1, B2)},
        g{A1 + A2} {}

  double spring_m() const {
    const double other_N = load.encoder_on_load ? A1 : A2;
    return ((Bs + other_N) * (Bs + other_N) / (2 * K) + other_N * G) / g;
  }

  // How far the spring may lead the side that is read once that was seen to rest, if friction falls then. No pulse does
  // any work, so that Theorem E has it within eps; and an axis that reads a count and a half more is kicked again.
  // Where that side alone holds all that the spring can pull, it stays.
  double creep_m() const {
    const double read_N = load.encoder_on_load ? A2 : A1;
    return Bs > read_N ? std::min(spring_m(), counts_to_leave_hold * unseen_m()) : 0;
  }

  double rest_s() const {
    const bool on_load = load.encoder_on_load;
    const double hidden_kg = heavier * (on_load ? load.motor_kg : load.load_kg), hidden_N = on_load ? A1 : A2;
    const double swings = 1 + std::ceil(std::max(((on_load ? B2 : B1) / hidden_N - 1) / 2, 0.0));
    return std::sqrt(2 * unseen_m() * heavier * M / g) + pi * std::sqrt(hidden_kg / K) * swings +
           std::sqrt(2 * swings * G * hidden_kg / hidden_N) + rest_within_a_count_s() + more_periods * axes.period_s;
  }

  double unseen_m() const { return axes.encoder_resolution_m + 4 * axes.encoder_noise_m; }

  // For how long the side that is read may swing within a count: beside the other one, which sticks, or against it.
  // Each half a swing takes twice the friction over K off its height. A stiffer joint swings more often.
  double rest_within_a_count_s() const {
    const bool on_load = load.encoder_on_load;
    const double read_kg = on_load ? load.load_kg : load.motor_kg, read_N = on_load ? A2 : A1;
    const double hidden_kg = on_load ? load.motor_kg : load.load_kg, hidden_N = on_load ? A1 : A2;
    const double stiffest = most_stiffer * K, held_N = unseen_m() * stiffest / 4;
    const double beside = held_N / read_N * std::sqrt(read_kg);
    const double against =
        held_N * M * M / (hidden_kg * (hidden_N * read_kg + read_N * hidden_kg)) * std::sqrt(read_kg * hidden_kg / M);
    return pi * std::sqrt(heavier / stiffest) * std::max(beside, against);
  }

  double swing_s() const { return 1 / load.resonance_Hz(); }

  // The least command that is sure to move the load in so many periods.
  double least_N(int periods) const {
    const double angle = std::min(std::sqrt(K / (heavier * load.motor_kg)) * periods * axes.period_s, pi / 2);
    const double force_N = sure_share * std::max(B1 + B2, B1 - Bs + (B2 + Bs) / (1 - std::cos(angle)));
    return force_N / axes.force_gain.least + axes.force_step_N;
  }

  // The command with which a rigid axis goes as far as y - eps, and no further than that before its motion is seen.
  // A meter may let a pulse be stronger: then it is at least the sure one.
  double force_N(double y_m, int periods) const {
    const double way_m = y_m - spring_m(), t = periods * axes.period_s;
    if (!(way_m > 0)) return 0;
    if (load.encoder_on_load) return unmetered_force_N(way_m, t) / axes.force_gain.most;
    double force = (g + std::sqrt(g * g + 8 * lighter * M * g * way_m / (t * t))) / 2;
    force = std::max(force, least_N(periods) * axes.force_gain.most);
    return std::min(force, unseen_force_N(way_m, std::min(periods, blind_periods()))) / axes.force_gain.most;
  }

  double late_periods() const {
    return axes.latency_periods + 1 + 2 * (axes.lag_s.most + axes.jitter_s) / axes.period_s;
  }

  // The least travel of the encoder's side in a kick, of some, however the spring is bent when they start; under
  // friction that is constant for each way and of either side its least, its greatest or between. The meter allows for
  // readings that show a count too little, and these show one too much.
  double least_travel_m(double y_m, double command_N, int periods, double enough_m) const {
    const double gained_m = std::max(axes.force_gain.most * command_N - held_back_N(), 0.0) * axes.period_s *
                            axes.period_s / (lighter * load.motor_kg);
    const double late = late_periods();
    detail::WorkTrial trial{.motor_kg = heavier * load.motor_kg,
                            .load_kg = heavier * load.load_kg,
                            .stiffness_N_per_m = K,
                            .gap_m = G,
                            .motor_friction = {B1, B1},
                            .load_friction = {B2, B2},
                            .period_s = axes.period_s,
                            .latency_periods = axes.latency_periods,
                            .metered = !load.encoder_on_load,
                            .encoder_on_load = load.encoder_on_load,
                            .most_travel_m = g * (y_m - spring_m()) / (axes.force_gain.most * command_N) -
                                             2 * unseen_m() * (1 + late) - gained_m * (late + late * late) / 2,
                            .late_periods = late,
                            .bent_m = 0};
    double least_m = least_of_bends_m(trial, axes.force_gain.least * command_N, periods, enough_m);
    if (least_m < enough_m) return least_m;
    if (trial.metered) {
      if (!(lighter < heavier) && !(axes.force_gain.least < axes.force_gain.most)) return least_m;
      // The faster a motor is, the sooner the meter ends its pulse.
      trial.motor_kg = lighter * load.motor_kg;
      trial.load_kg = lighter * load.load_kg;
      return std::min(least_m, least_of_bends_m(trial, axes.force_gain.most * command_N, periods, enough_m));
    }
    for (const double times : stiffer_joints) {
      trial.stiffness_N_per_m = times * K;
      least_m = std::min(least_m, least_of_bends_m(trial, axes.force_gain.least * command_N, periods, enough_m));
      if (least_m < enough_m) return least_m;
    }
    return least_m;
  }

  // A kick that does nothing leaves the spring bent as it was, and so do all that follow it: no bend may let one.
  double least_of_bends_m(detail::WorkTrial trial, double force_N, int periods, double enough_m) const {
    double least_m = infinite;
    for (const auto& [of_motor, of_load] : shares) {
      trial.motor_friction = {A1 + of_motor.towards_N * (B1 - A1), A1 + of_motor.back_N * (B1 - A1)};
      trial.load_friction = {A2 + of_load.towards_N * (B2 - A2), A2 + of_load.back_N * (B2 - A2)};
      const double ahead_N = std::min(trial.motor_friction.back_N, trial.load_friction.towards_N);
      const double behind_N = std::min(trial.motor_friction.towards_N, trial.load_friction.back_N);
      for (const double bent : bends) {
        trial.bent_m = bent * (bent > 0 ? ahead_N : behind_N) / trial.stiffness_N_per_m + std::copysign(G / 2, bent);
        const auto end = trial.run(force_N, periods);
        least_m = std::min(least_m, load.encoder_on_load ? end.load_m : end.motor_m);
        if (least_m < enough_m) return least_m;
      }
    }
    return least_m;
  }

  int blind_periods() const { return axes.latency_periods + 1; }
  // What the spring cannot have added to a pulse, of the force that acts.
  double held_back_N() const { return A1 - Bs; }

  const BrakedClass& axes;
  const SpringLoad& load;
  double K, G, M, heavier, lighter, A1, A2, B1, B2, Bs, g;

 private:
  // Of the way from the least friction to the greatest.
  struct Shares {
    detail::WorkTrial::Friction of_motor, of_load;
  };
  // Without a meter a pulse is whole swings of the told stiffness only.
  static constexpr std::array<double, 2> stiffer_joints{2, 6};
  static constexpr std::array<Shares, 6> shares{
      {{{1, 1}, {1, 1}}, {{1, 0}, {1, 0}}, {{1, 0}, {1, 1}}, {{0, 0}, {1, 1}}, {{1, 1}, {0, 0}}, {{0, 0}, {0, 0}}}};
  // Of what both sides hold; which is ahead where the bend is above 0.
  static constexpr std::array<double, 5> bends{1, -1, 0.6, 0.3, 0};

  // Of the force that acts: whose work is at most what friction takes on the way. More than the drive has is not told
  // apart.
  double unmetered_force_N(double way_m, double pulse_s) const {
    const PulseWork pulse{.motor_kg = lighter * load.motor_kg,
                          .load_kg = lighter * load.load_kg,
                          .stiffness_N_per_m = K,
                          .gap_m = G,
                          .motor_friction_N = A1,
                          .load_friction_N = A2,
                          .held_N = Bs,
                          .lag_s = axes.lag_s.most};
    double lawful_N = g, more_N = 1.01 * axes.force_gain.most * axes.max_force_N;
    if (!(pulse.most_J(lawful_N, pulse_s) <= g * way_m)) return 0;
    if (pulse.most_J(more_N, pulse_s) <= g * way_m) return more_N;
    for (int halving = 0; halving < 60; ++halving) {
      const double between_N = (lawful_N + more_N) / 2;
      (pulse.most_J(between_N, pulse_s) <= g * way_m ? lawful_N : more_N) = between_N;
    }
    return lawful_N;
  }

  // F (F - h) t^2 / (2 m1) = g way
  double unseen_force_N(double way_m, int periods) const {
    const double t = periods * axes.period_s + 2 * axes.lag_s.most, h = held_back_N();
    const double product = 2 * lighter * load.motor_kg * g * way_m / (t * t);
    return std::max((h + std::sqrt(h * h + 4 * product)) / 2, 0.0);
  }
};

template <class Real>
class WorkTable {
 public:
  using Table = law::KickTable<Real>;

  // reach_m: the distance up to which kicks are needed.
  WorkTable(const Jointed& axis, double reach_m) : axis_{axis}, swing_{swing_periods(axis)} {
    const double from_m = axis.spring_m() + axis.axes.encoder_resolution_m / 4;
    const std::uint32_t least = interval_of(from_m), last = least + 16 * 12;
    // From where no pulse is sure, an interval at a time, until one is in each that follows.
    for (std::uint32_t first = least; first < last && !reaches(reach_m); first += table_.count + 1u) {
      table_.count = 0;
      table_.first = static_cast<std::uint16_t>(first);
      while (table_.count < Table::most_entries && add(first + table_.count)) {
      }
    }
  }

  static int swing_periods(const Jointed& axis) {
    return static_cast<int>(std::clamp(std::round(axis.swing_s() / axis.axes.period_s), 1.0, 1e6));
  }
  const Table& table() const { return table_; }

 private:
  static constexpr int samples = 32;
  static constexpr double good_share = 0.2, enough_share = 0.05;
  bool reaches(double reach_m) const { return table_.count > 0 && static_cast<double>(table_.reach_m()) >= reach_m; }
  static std::uint32_t interval_of(double distance_m) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(std::sqrt(distance_m))) >> Table::shift;
  }
  double at(std::uint32_t high, double t, int n) const {
    const double s = Table::root_at(high) + t * (Table::root_at(high + 1) - Table::root_at(high));
    return axis_.force_N(s * s, n);
  }

  bool fits(std::uint32_t high, int n) const {
    return at(high, 0, n) >= axis_.least_N(n) * (1 - 1e-9) && at(high, 1, n) <= axis_.axes.max_force_N;
  }
  // Of the distance, that the kick takes away at least. What is less than asked for is not followed further.
  double least_share(std::uint32_t high, int n, double asked) const {
    double least = infinite;
    for (const double t : {0.0, 0.999}) {
      const double s = Table::root_at(high) + t * (Table::root_at(high + 1) - Table::root_at(high));
      const double command_N = at(high, t, n) - axis_.axes.force_step_N;
      least = std::min(least, axis_.least_travel_m(s * s, command_N, n, asked * s * s) / (s * s));
      if (least < asked) return least;
    }
    return least;
  }

  // Whole swings as few as the force allows, or else, near the floor, what gets on best.
  std::optional<int> periods(std::uint32_t high) const {
    for (int n = swing_; n <= longest_pulse_periods; n += swing_)
      if (fits(high, n) && least_share(high, n, good_share) >= good_share) return n;
    std::optional<int> best;
    double most = enough_share;
    const auto consider = [&](int n) {
      if (!fits(high, n)) return;
      const double share = least_share(high, n, most);
      if (share > most) most = share, best = n;
    };
    const int stride = std::max(1, swing_ / 6);
    for (int n = std::min(swing_, longest_pulse_periods); n >= 1; n -= stride) consider(n);
    for (int n = 2 * swing_; n <= std::min(4 * swing_, longest_pulse_periods); n += swing_) consider(n);
    return best;
  }

  bool add(std::uint32_t high) {
    const std::optional<int> n = periods(high);
    if (!n) return false;
    const std::array<double, 4> f{at(high, 0, *n), at(high, 1.0 / 3, *n), at(high, 2.0 / 3, *n), at(high, 1, *n)};
    const double a0 = f[0], a1 = (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]) / 2,
                 a2 = (18 * f[0] - 45 * f[1] + 36 * f[2] - 9 * f[3]) / 2,
                 a3 = (-9 * f[0] + 27 * f[1] - 27 * f[2] + 9 * f[3]) / 2;
    double over = 0;
    for (int j = 0; j <= samples; ++j) {
      const double t = static_cast<double>(j) / samples;
      over = std::max(over, a0 + t * (a1 + t * (a2 + t * a3)) - at(high, t, *n));
    }
    const double lowered = 1.05 * over + 1e-6 * f[3];
    table_.entries[table_.count] = {static_cast<Real>(a0 - lowered), static_cast<Real>(a1), static_cast<Real>(a2),
                                    static_cast<Real>(a3)};
    table_.periods[table_.count] = static_cast<std::uint8_t>(*n);
    ++table_.count;
    return true;
  }

  const Jointed& axis_;
  int swing_;
  Table table_{};
};

// The force of the feedback for each metre of the side that is read, in a motion as e^(s t): a reading is as late as
// the latency and the spans of place and speed make it, and a force is held for a period, behind the current loop.
template <class Real>
std::complex<double> feedback_N_per_m(const BrakedClass& c, const law::ShapedApproach<Real>& a,
                                      std::complex<double> s) {
  const double T = c.period_s, span_s = a.speed_periods * T, mean_s = a.mean_periods * T;
  const auto place = static_cast<double>(a.stiffness_N_per_m) * (1.0 + std::exp(-s * mean_s)) / 2.0;
  const auto speed = static_cast<double>(a.damping_Ns_per_m) * (1.0 - std::exp(-s * span_s)) / span_s;
  const auto held = (1.0 - std::exp(-s * T)) / (s * T);
  return (place + speed) * std::exp(-s * (c.latency_periods * T)) * held / (1.0 + s * c.lag_s.most);
}

// By which share a swing of the joint grows in a radian of it at the worst, whose masses are so many times as heavy.
// The root of the loop is followed from the free swing on, as the feedback grows to what it is: one that is no small
// force beside the spring's shifts the swing, and with it how late a reading is; and one that is limited acts as a
// share of it. To the first order of the feedback it is to be kept as well.
template <class Real>
double growth_of_swing(const Jointed& axis, const law::ShapedApproach<Real>& a, double stiffness_N_per_m, double gain,
                       double heavier) {
  using Complex = std::complex<double>;
  constexpr int shares = 8, corrections = 4;
  const double m1 = heavier * axis.load.motor_kg, m2 = heavier * axis.load.load_kg;
  const double w = std::sqrt(stiffness_N_per_m * (1 / m1 + 1 / m2)), h = 1e-6 * w;
  const auto loop = [&](Complex s, double share) {
    const Complex joint = axis.load.damping_Ns_per_m * s + stiffness_N_per_m;
    const Complex free = m1 * m2 * s * s * s * s + (m1 + m2) * joint * s * s;
    const Complex read = axis.load.encoder_on_load ? joint : m2 * s * s + joint;
    return free + share * gain * feedback_N_per_m(axis.axes, a, s) * read;
  };
  const auto slope = [&](Complex s, double share) { return (loop(s + h, share) - loop(s - h, share)) / (2 * h); };
  Complex root{0, w};
  double growth = -(loop(root, 1) / slope(root, 0)).real() / w;
  for (int i = 1; i <= shares; ++i) {
    const double share = static_cast<double>(i) / shares;
    for (int j = 0; j < corrections; ++j) root -= loop(root, share) / slope(root, share);
    growth = std::max(growth, root.real() / std::abs(root.imag()));
  }
  return std::isfinite(root.real() / root.imag()) ? growth : infinite;
}

// At any stiffness of the class, which is not looked at further once it grows by more than is allowed.
template <class Real>
double worst_growth_of_swing(const Jointed& axis, const law::ShapedApproach<Real>& a) {
  const Interval gain = axis.axes.force_gain;
  double worst = -infinite;
  for (double stiffer = 1; stiffer <= most_stiffer && worst <= most_swing_growth; stiffer *= 1.05) {
    const double K = stiffer * axis.K;
    worst = std::max({worst, growth_of_swing(axis, a, K, gain.most, axis.lighter),
                      growth_of_swing(axis, a, K, gain.least, axis.heavier)});
  }
  return worst;
}

// Feedback over these spans, as fast as lateness and the swing allow.
template <class Real>
double set_feedback(const Jointed& axis, int speed_periods, int mean_periods, law::ShapedApproach<Real>& a) {
  const BrakedClass& c = axis.axes;
  const bool on_load = axis.load.encoder_on_load;
  const double w = 2 * pi * axis.load.resonance_Hz();
  const double late_s =
      (c.latency_periods + 1 + std::max(speed_periods, mean_periods) / 2.0) * c.period_s + c.lag_s.most;
  // Above the resonance the motor moves alone.
  const double alone = on_load ? 1 : axis.load.motor_kg / axis.M;
  const double fastest = std::min(0.12 * w, 0.4 * alone / late_s);
  a.speed_periods = static_cast<std::uint8_t>(speed_periods);
  a.mean_periods = static_cast<std::uint8_t>(mean_periods);
  for (double response = fastest;; response *= 0.95) {
    a.stiffness_N_per_m = static_cast<Real>(axis.M * response * response);
    a.damping_Ns_per_m = static_cast<Real>(2 * axis.M * response);
    if (worst_growth_of_swing(axis, a) <= most_swing_growth) return response;
    if (response < fastest / 20) return 0;
  }
}

template <class Real>
law::ShapedApproach<Real> approach_of(const Jointed& axis, int swing_periods) {
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

// What leads an approach off its plan, by the feedback of its second order, which is damped critically if readings were
// not late: a force D leads it D/k off, and changes its speed by 2/e D/(M w) at most, whenever it begins and ends.
// Mass and gain that are off in the plan's acceleration, whose two parts undo each other, change the speed by no more
// than twice what they are off of the speed that is planned. Once the plan is over, friction alone stops what is left.
struct OffPlan {
  template <class Real>
  OffPlan(const Jointed& axis, const law::ShapedApproach<Real>& a, double max_speed_m_s) {
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
    const double swung_m = 2 * swung_N / axis.K;
    // Across the gap the force of the plan moves one side alone.
    const double alone_N = axis.M * planned_m_s2 + axis.B1 + axis.B2;
    const double across_m_s = std::sqrt(2 * alone_N * axis.G / std::min(axis.load.motor_kg, axis.load.load_kg));
    beyond_m = surely * (off_m + axis.heavier * axis.M * speed_m_s * speed_m_s / (2 * axis.g) + swung_m + axis.G);
    faster_m_s = late * (speed_m_s + swung_m * 2 * pi * axis.load.resonance_Hz() + across_m_s);
  }

  double beyond_m, faster_m_s;

 private:
  static constexpr double late = 1.5;  // by which it is more where readings are: tested,
  static constexpr double surely = 5;  // as is this, of axes that are read at their load and begin near their target
};

}  // namespace

template <class Real>
double approach_peak_m_s(const BrakedClass& axes, const WorkDesign<Real>& design, double max_speed_m_s) {
  return max_speed_m_s + OffPlan{Jointed{axes}, design.kicks.approach, max_speed_m_s}.faster_m_s;
}

template <class Real>
double approach_beyond_m(const BrakedClass& axes, const WorkDesign<Real>& design, double max_speed_m_s) {
  return OffPlan{Jointed{axes}, design.kicks.approach, max_speed_m_s}.beyond_m;
}

template <class Real>
WorkDesign<Real> design_work_kicks(const BrakedClass& axes) {
  const Jointed axis{axes};
  WorkDesign<Real> d;
  const int swing = WorkTable<Real>::swing_periods(axis);
  d.resonance_Hz = axis.load.resonance_Hz();
  d.unseen_m = axis.load.unseen_m(axes.load_N) + axis.G / 2;
  d.rest_s = axis.rest_s();
  d.holds = axis.A1 > 0;
  d.swing_is_counted = d.resonance_Hz * axes.period_s * least_swing_periods <= 1 && swing <= longest_pulse_periods;
  if (!d.holds || !d.swing_is_counted) return d;
  d.spring_m = axis.spring_m();
  d.pulse_needed_N = axis.least_N(swing);
  d.moves_load = d.pulse_needed_N <= axes.max_force_N;
  if (!d.moves_load) return d;

  law::WorkKicks<Real>& k = d.kicks;
  k.force_step_N = static_cast<Real>(axes.force_step_N);
  k.slow_lag = static_cast<Real>(axes.lag_s.most > 0 ? std::exp(-axes.period_s / axes.lag_s.most) : 0);
  k.breakaway_N = static_cast<Real>((axis.B1 + axis.B2) / axes.force_gain.least);
  k.lost_motion_m = static_cast<Real>(lost_motion_m(axes));
  k.spring_m = static_cast<Real>(d.spring_m);
  d.creep_m = axis.creep_m();
  k.creep_m = static_cast<Real>(d.creep_m);
  k.friction_per_gain_N = static_cast<Real>(axis.g / axes.force_gain.most);
  k.speeding_s_per_kg = static_cast<Real>(axes.force_gain.most * axes.period_s / (axis.lighter * axis.load.motor_kg));
  k.held_back_N = static_cast<Real>(axis.held_back_N() / axes.force_gain.most);
  k.late_periods = static_cast<Real>(axis.late_periods());
  k.still_periods = static_cast<std::uint16_t>(std::min(std::ceil(d.rest_s / axes.period_s), 65535.0));
  k.metered = !axis.load.encoder_on_load;
  k.approach = approach_of<Real>(axis, swing);
  d.swing_growth = worst_growth_of_swing(axis, k.approach);
  k.table = WorkTable<Real>{axis, static_cast<double>(k.begin_m())}.table();
  if (k.table.count == 0) return d;
  d.floor_m = static_cast<double>(k.table.least_m());
  d.reach_m = static_cast<double>(k.table.reach_m());
  d.least_tolerance_m =
      std::max(d.floor_m + axes.reading_error_m(), least_counts * axes.encoder_resolution_m) + d.creep_m;
  double most_Ns = 0;
  for (std::size_t i = 0; i < k.table.count; ++i) {
    const auto& e = k.table.entries[i];
    const double force_N = std::max(double{e.a0}, double{e.a0} + e.a1 + e.a2 + e.a3);
    most_Ns = std::max(most_Ns, force_N * k.table.periods[i] * axes.period_s * axes.force_gain.most);
  }
  d.peak_speed_m_s =
      std::sqrt((2 * axis.g * d.reach_m + axis.Bs * axis.Bs / axis.K) / (axis.lighter * axis.load.motor_kg));
  k.longest_coast_periods =
      static_cast<std::uint16_t>(std::min(most_Ns / axis.g / axes.period_s + k.still_periods, 15000.0));
  k.patient_periods = static_cast<std::uint16_t>(std::min(k.still_periods + 4.0 * swing + 50, 65535.0));
  d.table_bytes = k.table.count * (sizeof k.table.entries[0] + 2);
  return d;
}

template WorkDesign<float> design_work_kicks(const BrakedClass&);
template WorkDesign<double> design_work_kicks(const BrakedClass&);
template double approach_peak_m_s(const BrakedClass&, const WorkDesign<float>&, double);
template double approach_peak_m_s(const BrakedClass&, const WorkDesign<double>&, double);
template double approach_beyond_m(const BrakedClass&, const WorkDesign<float>&, double);
template double approach_beyond_m(const BrakedClass&, const WorkDesign<double>&, double);

}  // namespace breakaway::design
