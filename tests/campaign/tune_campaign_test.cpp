// Random axes: `new` and `tune` certify each, or say in a sentence which number forbids it, and what is tuned settles
// as fast as the best of a brute-force search does, that shares nothing with the search but the study.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/edited_file.hpp"
#include "breakaway/config/new_node.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/study/friction_study.hpp"
#include "breakaway/study/tune.hpp"
#include "environment.hpp"

namespace breakaway::campaign {
namespace {

using config::KnownAxis;
using config::Setting;

class Random {
 public:
  explicit Random(long number) : engine_{static_cast<std::uint64_t>(number) + 20261123} {}
  double between(double least, double most) {
    return least + (most - least) * std::generate_canonical<double, 53>(engine_);
  }
  double decades(double least, double most) { return least * std::pow(most / least, between(0, 1)); }

 private:
  std::mt19937_64 engine_;
};

double digits(double value, int count) {
  return std::stod([&] {
    char text[40];
    std::snprintf(text, sizeof text, "%.*e", count - 1, value);
    return std::string{text};
  }());
}

// 0.05 to 200 kg, friction bounds 0.25 to 0.95 apart, 0.25 to 4 ms, 10 nm to 100 um, 2 to 20 times the friction, moves
// from a hundred counts on that the force makes in 0.05 to 2 s. Drives are told of periods in steps of 10 us.
KnownAxis random_axis(long number) {
  Random r{number};
  KnownAxis k;
  k.mass_kg = digits(r.decades(0.05, 200), 4);
  k.friction_upper_N = digits(k.mass_kg * r.decades(0.3, 30), 4);
  k.friction_lower_N = digits(k.friction_upper_N * r.between(0.25, 0.95), 4);
  k.encoder_resolution_m = digits(r.decades(1e-8, 1e-4), 2);
  k.rate_Hz = 1 / (1e-5 * std::round(1e5 * r.decades(2.5e-4, 4e-3)));
  k.max_force_N = digits(k.friction_upper_N * r.decades(2, 20), 4);
  const double time_s = r.decades(0.05, 2), surplus_N = k.max_force_N - k.friction_upper_N;
  k.longest_move_m =
      digits(std::clamp(surplus_N / k.mass_kg * time_s * time_s / 4, 100 * k.encoder_resolution_m, 4.0), 3);
  return k;
}

double worst_settling_s(const std::string& text, double distance_m, int random_laws, double longest_s) try {
  scenario::Scenario s = scenario::parse_scenario(text, "brute.toml");
  if (!config::why_not_certified(s.node, s.node.axes.front()).empty()) return std::numeric_limits<double>::infinity();
  s.run->duration_s = longest_s;
  return study::worst_settling_time_s(study::run_study(s, {{{-distance_m, 0}}, random_laws, 1, 0, {}}).front());
} catch (const InputError&) {
  return std::numeric_limits<double>::infinity();
}

// A grid over speed, and over speed and acceleration of a [move].
double best_by_force_s(const std::string& text, const KnownAxis& known, int random_laws, double longest_s) {
  const scenario::Scenario s = scenario::parse_scenario(text, "brute.toml");
  const double speed_m_s = s.node.axes.front().controller.max_approach_speed_m_s;
  const double hardest = (known.max_force_N - known.friction_upper_N) / known.mass_kg;
  double best_s = std::numeric_limits<double>::infinity();
  const auto attempt = [&](const std::vector<Setting>& settings) {
    const std::string tried = config::with_settings(text, "brute.toml", "", settings);
    best_s = std::min(best_s, worst_settling_s(tried, known.longest_move_m, random_laws, longest_s));
  };
  const auto number = [](double value) { return std::to_string(value); };
  for (int i = 0; i < 16; ++i) attempt({{"controller", "max_approach_speed_m_s", number(speed_m_s * (1 - i / 18.0))}});
  for (const double acceleration : {0.98, 0.85, 0.7, 0.5}) {
    for (const double speed : {1.0, 0.8, 0.6})
      attempt({{"move", "distance_m", number(known.longest_move_m)},
               {"move", "speed_m_s", number(speed * speed_m_s)},
               {"move", "acceleration_m_s2", number(acceleration * hardest)}});
  }
  return best_s;
}

struct Tally {
  long certified = 0, refused = 0;
  double worst_ratio = 0, longest_tune_s = 0;
};

void expect_a_sentence(const InputError& error, long number) {
  const std::string what = error.what();
  EXPECT_EQ(what.find('\n'), std::string::npos) << number;
  EXPECT_GT(what.size(), 30U) << number << ": " << what;
}

std::optional<std::string> new_file(const KnownAxis& known, long number) try {
  return config::new_node(known).text;
} catch (const InputError& error) {
  expect_a_sentence(error, number);
  return {};
}

void run(long number, int random_laws, bool by_force, Tally& tally) {
  const KnownAxis known = random_axis(number);
  SCOPED_TRACE("axis " + std::to_string(number));
  const std::optional<std::string> file = new_file(known, number);
  if (!file) return static_cast<void>(++tally.refused);
  study::TuneOptions options;
  options.random_laws = random_laws;
  options.double_limits = set_in_environment("BREAKAWAY_TUNE_LIMITS");
  const auto begin = std::chrono::steady_clock::now();
  try {
    const study::Tuning tuning = study::tune(*file, "axis.toml", options);
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    tally.longest_tune_s = std::max(tally.longest_tune_s, took_s);
    ++tally.certified;
    const double worst_s = worst_settling_s(tuning.text, known.longest_move_m, random_laws, 1e3);
    EXPECT_EQ(worst_s, tuning.chosen.worst_settling_s) << "a study of the file says the same";
    if (!by_force) return;
    const double best_s = best_by_force_s(*file, known, random_laws, 2 * worst_s + 0.2);
    tally.worst_ratio = std::max(tally.worst_ratio, worst_s / best_s);
    EXPECT_LE(worst_s, 1.1 * best_s) << best_s << " s by force";
  } catch (const InputError& error) {
    ADD_FAILURE() << "new certifies what tune refuses: " << error.what();
  }
}

TEST(TuneCampaign, IsCertifiedAndAsFastAsABruteForceSearch) {
  const long first = from_environment("BREAKAWAY_FIRST_AXIS", 0), axes = from_environment("BREAKAWAY_TUNED_AXES", 3);
  const auto laws = static_cast<int>(from_environment("BREAKAWAY_TUNE_LAWS", 20));
  Tally tally;
  for (long number = first; number < first + axes; ++number) {
    run(number, laws, !set_in_environment("BREAKAWAY_NO_BRUTE_FORCE"), tally);
    std::printf("to axis %ld: %ld certified, %ld refused, at most %.3f times the best by force, %.1f s for one\n",
                number, tally.certified, tally.refused, tally.worst_ratio, tally.longest_tune_s);
    std::fflush(stdout);
  }
  EXPECT_GE(2 * tally.certified, axes / 2);
}

}  // namespace
}  // namespace breakaway::campaign
