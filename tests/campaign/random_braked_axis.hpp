// Random axes under the coast "brake", and every kind of friction that their bounds allow.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <random>
#include <utility>

#include "../kicked_axis.hpp"

namespace breakaway::campaign {

using design::BrakedClass;
using design::Interval;
using testing::Friction;
using testing::Moment;

constexpr int kinds = 13;  // of friction

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_{seed} {}
  double share() { return std::uniform_real_distribution<>{0, 1}(bits_); }
  double between(double low, double high) { return low + (high - low) * share(); }
  double decades(double low, double high) { return low * std::pow(high / low, share()); }
  // An end of the interval as often as something between.
  double inside(const Interval& i) {
    const double choice = share();
    return choice < 0.3 ? i.least : choice < 0.6 ? i.most : between(i.least, i.most);
  }
  template <std::size_t N>
  double one_of(const std::array<double, N>& values) {
    return values[static_cast<std::size_t>(share() * N)];
  }

 private:
  std::mt19937_64 bits_;
};

// The whole range that is accepted: masses of a gram to ten tonnes, counts of a nanometre to a millimetre.
inline BrakedClass random_axes(Random& r) {
  BrakedClass c;
  const double m = r.decades(1e-3, 1e4), B = r.decades(0.1, 1e3),
               A = r.share() < 0.1 ? 0.999 * B : B * r.between(0.1, 1);
  c.friction = {A, B};
  c.period_s = 1e-3 * r.one_of<7>({0.1, 0.25, 0.5, 1, 2, 4, 10});
  c.encoder_resolution_m = r.decades(1e-9, 1e-3);
  c.max_force_N = B * (1.5 + 20 * std::pow(r.share(), 2));
  c.force_step_N =
      r.share() < 0.2 ? A * r.decades(0.1, 4) : c.max_force_N / r.one_of<7>({2000, 2000, 1000, 400, 100, 50, 20});
  c.latency_periods = static_cast<int>(r.between(0, 4));
  const auto about = [&](double value, double most_share) {
    const double share = r.share() < 0.5 ? 0 : most_share * r.share();
    return Interval{value * (1 - share), value * (1 + share)};
  };
  c.mass_kg = about(m, 0.2);
  c.force_gain = about(1, 0.2);
  c.lag_s = about(r.share() < 0.3 ? 0 : c.period_s * r.between(0, 5), 0.2);
  c.load_N = r.share() < 0.6 ? 0 : r.between(0, 0.5 * A);
  if (r.share() < 0.3) c.jitter_s = c.period_s * design::most_jitter * (r.share() < 0.3 ? 1 : r.share());
  if (r.share() < 0.3) c.encoder_noise_m = c.encoder_resolution_m;
  return c;
}

// A bus of this class, which loses a sample of a hundred beside.
inline testing::Disturbance disturbance(const BrakedClass& c, Random& r) {
  return {.jitter_s = c.jitter_s,
          .noise_m = c.encoder_noise_m,
          .lost_share = r.share() < 0.5 ? 0.01 : 0,
          .seed = static_cast<std::uint64_t>(1e9 * r.share())};
}

inline law::AxisParameters<float> parameters(const BrakedClass& c, double tolerance_m) {
  law::AxisParameters<float> p;
  const auto m = static_cast<float>((c.mass_kg.least + c.mass_kg.most) / 2);
  p.mass_kg = m;
  p.stiffness_N_per_m = 100 * m;  // not used
  p.approach_damping_Ns_per_m = 15 * m;
  p.kick_damping_Ns_per_m = 25 * m;
  p.friction = {static_cast<float>(c.friction.lower_N), static_cast<float>(c.friction.upper_N)};
  p.max_force_N = static_cast<float>(c.max_force_N);
  p.max_approach_speed_m_s = 10;
  p.position_tolerance_m = static_cast<float>(tolerance_m);
  p.encoder_resolution_m = static_cast<float>(c.encoder_resolution_m);
  p.flicker_m = static_cast<float>(c.flicker_m());
  p.period_s = static_cast<float>(c.period_s);
  p.latency_periods = static_cast<std::uint8_t>(c.latency_periods);
  p.coast = law::Coast::brake;
  return p;
}

// A friction that changes when the axis slips, by a plan that its last stop has drawn: low or high all the way, high to
// break away and low from then on, or either first and the other later. That is the adversary who decides kick by kick.
class Adversary {
 public:
  Adversary(double low_N, double high_N, double period_s, std::uint64_t seed)
      : low_N_{low_N}, high_N_{high_N}, period_s_{period_s}, random_{seed} {}
  double operator()(const Moment& now) {
    if (now.slips_now && !slipped_) {
      plan_ = static_cast<int>(5 * random_.share());
      since_s_ = now.t_s;
    }
    slipped_ = now.slips_now;
    const bool early = now.t_s - since_s_ < 2 * period_s_;
    const bool high = plan_ == 1 || (plan_ == 2 && now.slips_now) || (plan_ == 3 && !early) || (plan_ == 4 && early);
    return high ? high_N_ : low_N_;
  }

 private:
  double low_N_, high_N_, period_s_;
  Random random_;
  double since_s_ = 0;
  int plan_ = 0;
  bool slipped_ = false;
};

// A friction that steers the axis, at each instant, to the place that is worst: it predicts where the axis would stop
// under its least, takes it while that is short of the place, and its greatest otherwise. For each slip it draws the
// place anew: as far beyond the target as the axis gets, where it hardly moved, just out of the tolerance on either
// side of the target, or where a reading is off by the most.
class GreedyAdversary {
 public:
  struct Aim {
    double mass_kg, tolerance_m, reading_error_m;
  };
  GreedyAdversary(double low_N, double high_N, const Aim& aim, std::uint64_t seed)
      : low_N_{low_N}, high_N_{high_N}, aim_{aim}, random_{seed} {}

  double operator()(const Moment& now) {
    if (now.velocity_m_s == 0) {
      if (!std::exchange(resting_, true)) draw(now);
      return hard_to_break_ ? high_N_ : low_N_;
    }
    resting_ = false;
    const double direction = now.velocity_m_s > 0 ? 1 : -1;
    const double braking_N = low_N_ - now.force_N * direction;
    const double way_m = aim_.mass_kg * now.velocity_m_s * now.velocity_m_s / (2 * braking_N);
    const bool gets_there = !(braking_N > 0) || direction * (now.position_m - place_m_) + way_m > 0;
    return gets_there ? high_N_ : low_N_;
  }

 private:
  void draw(const Moment& now) {
    const double towards = now.position_m > 0 ? -1 : 1, edge_m = aim_.tolerance_m + aim_.reading_error_m;
    const std::array<double, 5> places{towards * INFINITY, now.position_m, -towards * edge_m, towards * edge_m,
                                       now.position_m + towards * aim_.reading_error_m};
    place_m_ = random_.one_of(places);
    hard_to_break_ = random_.share() < 0.7;
  }

  double low_N_, high_N_;
  Aim aim_;
  Random random_;
  double place_m_ = 0;
  bool resting_ = false, hard_to_break_ = true;
};

// Each thing that is told is right or off by up to 2 times, as often as not.
struct Wrong {
  testing::TrueAxis axis;
  law::FrictionBounds<double> friction;

  Wrong(const BrakedClass& c, Random& r) {
    const auto off = [&](double value) { return r.share() < 0.5 ? value : value * std::pow(2, r.between(-1, 1)); };
    axis.mass_kg = off(r.inside(c.mass_kg));
    axis.force_gain = off(r.inside(c.force_gain));
    axis.lag_s = c.lag_s.most > 0 ? off(r.inside(c.lag_s)) : r.share() < 0.5 ? 0 : c.period_s * r.between(0, 2);
    axis.latency_periods = static_cast<int>(std::lround(off(c.latency_periods + 1) - 1));
    friction = {off(c.friction.lower_N), off(c.friction.upper_N)};
    if (friction.lower_N > friction.upper_N) std::swap(friction.lower_N, friction.upper_N);
    axis.load_N = off(r.inside({-c.load_N, c.load_N}));
    if (c.load_N == 0 && r.share() < 0.3) axis.load_N = r.between(-0.5, 0.5) * c.friction.lower_N;
  }
};

inline double hashed_share(double cell, std::uint64_t seed) {
  std::uint64_t h = static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) * 0x9E3779B97F4A7C15U + seed;
  h = (h ^ (h >> 31)) * 0xBF58476D1CE4E5B9U;
  return static_cast<double>((h ^ (h >> 29)) & 0xFFFFU) / 65535;
}

inline Friction friction_of_kind(int kind, const BrakedClass& c, std::uint64_t seed, double length_m,
                                 double tolerance_m) {
  const double A = c.friction.lower_N, B = c.friction.upper_N, T = c.period_s;
  const auto r = std::make_shared<Random>(seed);
  const double middle = r->between(A, B), phase = r->between(0, 6);
  const auto drawn = [=] { return r->inside({A, B}); };
  switch (kind) {
    case 0:
      return [=](const Moment&) { return A; };
    case 1:
      return [=](const Moment&) { return B; };
    case 2:
      return [=](const Moment&) { return middle; };
    case 3:
      return [=](const Moment& now) { return now.slips_now ? B : A; };
    case 4:
      return [=](const Moment& now) { return A + (B - A) * std::exp(-std::fabs(now.velocity_m_s) / 0.02); };
    case 5:
      return [=](const Moment& now) { return A + (B - A) * (0.5 + 0.5 * std::sin(now.position_m / length_m + phase)); };
    case 6:
      return [=](const Moment& now) { return A + (B - A) * hashed_share(std::floor(now.position_m / length_m), seed); };
    case 7:
      return [=](const Moment& now) { return (now.velocity_m_s == 0 ? now.force_N : now.velocity_m_s) > 0 ? A : B; };
    case 8:
      return [=, next_s = 0.0, level = middle](const Moment& now) mutable {
        if (now.t_s >= next_s) next_s = now.t_s + T * r->decades(0.1, 100), level = drawn();
        return level;
      };
    case 9:
      return [=, level = middle, slipped = false](const Moment& now) mutable {
        if (now.slips_now && !slipped) level = drawn();
        slipped = now.slips_now;
        return level;
      };
    case 10:
      return Adversary{A, B, T, seed};
    case 11:
      return GreedyAdversary{A, B, {c.mass_kg.most, tolerance_m, c.reading_error_m()}, seed};
    default:
      return [=](const Moment& now) {
        const bool closing = now.position_m * now.velocity_m_s < 0;
        return now.slips_now || (closing && std::fabs(now.position_m) > 4 * length_m) ? B : A;
      };
  }
}

// Anywhere inside what is told.
inline testing::TrueAxis true_axis(const BrakedClass& c, Random& r) {
  return {r.inside(c.mass_kg), r.inside(c.force_gain), r.inside(c.lag_s), r.inside({-c.load_N, c.load_N}),
          c.latency_periods};
}

// A number from the environment.
inline long asked_for(const char* variable, long otherwise) {
  const char* asked = std::getenv(variable);
  return asked != nullptr ? std::atol(asked) : otherwise;
}

}  // namespace breakaway::campaign
