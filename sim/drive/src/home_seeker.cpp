#include "breakaway/drive_emulator/home_seeker.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace breakaway::drive_emulator {
namespace {

constexpr double period_s = 500e-6;
constexpr double integral_per_s = 20;
constexpr std::int64_t without_index = 16;  // of a method, and the one that is like it, but for the index pulse

}  // namespace

bool HomeSeeker::knows(std::int64_t method) {
  const bool with_index = method >= 1 && method <= 14, without = method >= 17 && method <= 30;
  return with_index || without || method == 33 || method == 34;
}

// Methods 17 to 30 are 1 to 14 without the index pulse. 3 and 4 are for a switch that is on above its edge, 5 and 6 for
// one that is on below it, and 7 to 14 for one that is on between two edges.
HomeSeeker::HomeSwitch HomeSeeker::home_switch_of(std::int64_t method) {
  const std::int64_t alike = method > without_index ? method - without_index : method;
  if (alike >= 7) return HomeSwitch::between;
  return alike >= 5 ? HomeSwitch::below : HomeSwitch::above;
}

// To a switch at speed, and off it, or on, slowly: home is where the switch changes, or at the next index pulse on the
// way.
HomeSeeker::Legs HomeSeeker::legs_of(std::int64_t method, double position_m) const {
  if (method > 30) return {Leg{method == 33 ? -1 : 1, Until::index, true}};
  const std::int64_t alike = method > without_index ? method - without_index : method;
  Legs legs = alike <= 2   ? legs_to_limit(alike == 1 ? -1 : 1)
              : alike <= 6 ? legs_to_edge(alike, position_m)
                           : legs_to_either_edge(alike, position_m);
  const auto end = std::ranges::find(legs, 0, &Leg::way);
  if (method < without_index) *end = Leg{std::prev(end)->way, Until::index, true};
  return legs;
}

HomeSeeker::Legs HomeSeeker::legs_to_limit(int way) const {
  if (way < 0) return {Leg{-1, Until::low_limit}, Leg{1, Until::no_low_limit, true}};
  return {Leg{1, Until::high_limit}, Leg{-1, Until::no_high_limit, true}};
}

// Odd methods find the edge on the way off the switch, even ones on the way onto it.
HomeSeeker::Legs HomeSeeker::legs_to_edge(std::int64_t method, double position_m) const {
  const bool switched = sees(Until::switched, position_m);
  const int up = home_switch_ == HomeSwitch::above ? 1 : -1;
  const Leg on{up, Until::switched}, off{-up, Until::not_switched};
  const Leg slowly_on{up, Until::switched, true}, slowly_off{-up, Until::not_switched, true};
  if (method % 2 != 0) return switched ? Legs{slowly_off} : Legs{on, slowly_off};
  return switched ? Legs{off, slowly_on} : Legs{on, off, slowly_on};
}

// 7 to 10 set out upwards: their homes are outside and inside of the edge that is met first, and inside and outside of
// the other one. 11 to 14 are their mirror images. From beyond the switch the way is to the limit and back.
HomeSeeker::Legs HomeSeeker::legs_to_either_edge(std::int64_t method, double position_m) const {
  const int out = method <= 10 ? 1 : -1;
  const bool switched = sees(Until::switched, position_m);
  const bool beyond = !switched && (position_m - switches_.home_m) * out > 0;

  std::vector<Leg> row;
  if (beyond) row = {Leg{out, out > 0 ? Until::high_limit : Until::low_limit}, Leg{-out, Until::switched}};
  if (!switched && !beyond) row = {Leg{out, Until::switched}};
  // It is on the switch.
  const std::int64_t place = (method - 7) % 4;
  const int first = place < 2 ? -out : out;
  row.push_back({first, Until::not_switched});
  if (place == 1 || place == 2) row.push_back({-first, Until::switched});
  row.back().slowly = true;
  Legs legs{};
  std::ranges::copy(row, legs.begin());
  return legs;
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
      if (home_switch_ == HomeSwitch::below) return position_m <= switches_.home_m;
      return position_m >= switches_.home_m &&
             (home_switch_ == HomeSwitch::above || position_m <= switches_.home_m + switches_.home_width_m);
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
  home_switch_ = home_switch_of(method);
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
