#include "breakaway/drive_emulator/home_seeker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakaway::drive_emulator {
namespace {

constexpr double period_s = 500e-6;
constexpr double integral_per_s = 20;

}  // namespace

bool HomeSeeker::knows(std::int64_t method) {
  constexpr std::array<std::int64_t, 10> known{1, 2, 17, 18, 19, 20, 21, 22, 33, 34};
  return std::ranges::find(known, method) != known.end();
}

// To a switch at speed, and off it, or on, slowly: home is where the switch changes, or at the next index pulse.
HomeSeeker::Legs HomeSeeker::legs_of(std::int64_t method, double position_m) const {
  const bool switched = sees(Until::switched, position_m);
  const Leg to_low{-1, Until::low_limit}, off_low{1, Until::no_low_limit, true};
  const Leg to_high{1, Until::high_limit}, off_high{-1, Until::no_high_limit, true};
  // The home switch is on above its edge for methods 19 and 20, and below it for 21 and 22.
  const int up = method <= 20 ? 1 : -1;
  const Leg on{up, Until::switched, method % 2 == 0}, off{-up, Until::not_switched, method % 2 != 0};
  switch (method) {
    case 1:
      return {to_low, off_low, Leg{1, Until::index, true}};
    case 2:
      return {to_high, off_high, Leg{-1, Until::index, true}};
    case 17:
      return {to_low, off_low};
    case 18:
      return {to_high, off_high};
    case 19:
    case 21:
      return switched ? Legs{off} : Legs{on, off};
    case 20:
    case 22:
      return switched ? Legs{off, on} : Legs{on};
    case 33:
      return {Leg{-1, Until::index, true}};
    default:
      return {Leg{1, Until::index, true}};
  }
}

bool HomeSeeker::sees(Until until, double position_m) const {
  const auto pulse = [this](double at_m) { return std::floor(at_m / switches_.index_distance_m); };
  switch (until) {
    case Until::low_limit:
      return position_m <= switches_.low_limit_m;
    case Until::no_low_limit:
      return position_m > switches_.low_limit_m;
    case Until::high_limit:
      return position_m >= switches_.high_limit_m;
    case Until::no_high_limit:
      return position_m < switches_.high_limit_m;
    case Until::switched:
      return switches_.home_on_above ? position_m >= switches_.home_m : position_m <= switches_.home_m;
    case Until::not_switched:
      return !sees(Until::switched, position_m);
    case Until::index:
      return pulse(position_m) != pulse(last_m_);
  }
  return false;
}

void HomeSeeker::start(const HomeSwitches& switches, std::int64_t method, const Speeds& speeds, double position_m) {
  *this = {};
  switches_ = switches;
  switches_.home_on_above = method <= 20;
  speeds_ = speeds;
  legs_ = legs_of(method, position_m);
  last_m_ = position_m;
  seeking_ = true;
}

// Ramps towards the leg's speed, and to none once the home was passed.
double HomeSeeker::wanted_speed_m_s() {
  const Leg leg = leg_ < legs_.size() ? legs_[leg_] : Leg{};
  const double end_m_s = leg.way * (leg.slowly ? speeds_.zero_m_s : speeds_.search_m_s);
  const double most_m_s = speeds_.acceleration_m_s2 * period_s;
  speed_m_s_ += std::clamp(end_m_s - speed_m_s_, -most_m_s, most_m_s);
  return speed_m_s_;
}

double HomeSeeker::step(double position_m, double most_N) {
  while (leg_ < legs_.size() && legs_[leg_].way != 0 && sees(legs_[leg_].until, position_m)) {
    ++leg_;
    if (leg_ == legs_.size() || legs_[leg_].way == 0) home_m_ = position_m;
  }
  const double moved_m = position_m - std::exchange(last_m_, position_m);
  const double error_m = wanted_speed_m_s() * period_s - moved_m;
  arrived_ = home_m_ && speed_m_s_ == 0 && moved_m == 0;
  const double gain_N_per_m = switches_.speed_gain_Ns_per_m / period_s;
  // What the force cannot follow is not summed up.
  const double most_m = most_N / (switches_.speed_gain_Ns_per_m * integral_per_s);
  integral_m_ = std::clamp(integral_m_ + error_m, -most_m, most_m);
  const double force_N = gain_N_per_m * error_m + switches_.speed_gain_Ns_per_m * integral_per_s * integral_m_;
  return std::clamp(force_N, -most_N, most_N);
}

}  // namespace breakaway::drive_emulator
