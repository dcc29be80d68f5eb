#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sprung.hpp"

namespace breakaway::evaluation {
namespace {

constexpr double least_Hz = 8, step_Hz = 1.5, most_per_period = 0.42;

// Of a few of the greatest switches, which show most.
std::vector<SwitchInMotion> greatest_steps(std::vector<SwitchInMotion> switches, std::size_t number) {
  std::ranges::stable_sort(switches, std::ranges::greater{}, [](const SwitchInMotion& s) {
    return std::abs(s.after_N - s.before_N) * static_cast<double>(std::min<std::size_t>(s.readings(), 100));
  });
  switches.resize(std::min(switches.size(), number));
  return switches;
}

class Search {
 public:
  Search(const Record& record, std::vector<SwitchInMotion> switches)
      : record_{record}, switches_{std::move(switches)} {}

  // Mean square of what the readings are off.
  double cost(const Swing& swing) const {
    double sum = 0;
    for (const SwitchInMotion& one : switches_) {
      const auto fit = fit_swing(record_, one, swing);
      if (!fit) return INFINITY;
      sum += fit->residual_m * fit->residual_m;
    }
    return sum;
  }

  Swing coarse() const {
    Swing best{};
    double least = INFINITY;
    for (double Hz = least_Hz; Hz * record_.period_s < most_per_period; Hz += step_Hz)
      for (int periods = 0; periods <= 4; ++periods) {
        const double w = 2 * std::numbers::pi * Hz;
        const Swing one{w, 0.01 * w, (periods + 0.1) * record_.period_s};
        const double now = cost(one);
        if (now < least) least = now, best = one;
      }
    return best;
  }

  // Steps along each of the three, shorter and shorter.
  Swing refined(Swing best) const {
    double least = cost(best);
    double rate_step = 2 * std::numbers::pi * step_Hz / 2, decay_step = best.decay_1_s;
    double delay_step = record_.period_s / 4;
    for (int round = 0; round < 24; ++round) {
      const auto try_one = [&](double rate, double decay, double delay) {
        Swing one = best;
        one.rate_rad_s += rate, one.delay_s = std::max(one.delay_s + delay, 0.0);
        one.decay_1_s = std::max(one.decay_1_s + decay, 0.0);
        const double now = cost(one);
        if (!(now < least)) return false;
        least = now, best = one;
        return true;
      };
      bool better = false;
      for (const double sign : {1.0, -1.0}) {
        better |= try_one(sign * rate_step, 0, 0);
        better |= try_one(0, sign * decay_step, 0);
        better |= try_one(0, 0, sign * delay_step);
      }
      if (!better) rate_step /= 2, decay_step /= 2, delay_step /= 2;
    }
    return best;
  }

 private:
  const Record& record_;
  std::vector<SwitchInMotion> switches_;
};

}  // namespace

std::optional<Swing> swing_of(const Record& record, const std::vector<SwitchInMotion>& switches) {
  constexpr std::size_t few = 6, more = 12, least = 4;
  if (switches.size() < least) return {};
  const Swing coarse = Search{record, greatest_steps(switches, few)}.coarse();
  const Swing swing = Search{record, greatest_steps(switches, more)}.refined(coarse);
  // A slower one has no whole swing in what a switch shows: it is fitted to friction that changes.
  if (swing.rate_rad_s < 2 * std::numbers::pi * least_Hz) return {};
  std::size_t seen = 0;
  for (const SwitchInMotion& one : greatest_steps(switches, more)) {
    const auto fit = fit_swing(record, one, swing);
    const double swing_m = fit ? fit->swing_m_per_N * std::abs(one.after_N - one.before_N) : 0;
    if (swing_m > 2 * record.resolution_m && swing_m > 3 * fit->residual_m) ++seen;
  }
  if (seen < least) return {};
  return swing;
}

}  // namespace breakaway::evaluation
