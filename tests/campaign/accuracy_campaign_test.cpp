// The accuracy that is asked for against the truth: on random machines and axes, is the error that a run tells the
// error that it makes, is what was asked for held, and does nothing that holds it cost less than half? README.md says
// what is counted and how a long run is made.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "axis_truth.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_accuracy.hpp"
#include "breakaway/sil/method_choice.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "environment.hpp"
#include "random_machine.hpp"
#include "reference_run.hpp"

namespace {

using namespace breakaway;
using namespace breakaway::campaign;

bool shown() { return set_in_environment("BREAKAWAY_SHOW"); }

// One run: what it is called, what it says of itself, and what is true.
struct Judged {
  std::string name;
  const sil::Accuracy& told;
  double asked_m, true_m;
  double rounding_m;  // below it an estimate cannot be told from the rounding of the data
};

// What is counted, over all runs that were judged.
struct Tally {
  long judged = 0, held = 0, bounded = 0, tight = 0, cheap = 0, compared = 0, refused = 0, unjudged = 0;

  void judge(const Judged& run) {
    const double estimate_m = run.told.error_estimate_m;
    ++judged;
    held += run.true_m <= run.asked_m ? 1 : 0;
    bounded += run.true_m <= 2 * estimate_m ? 1 : 0;
    tight += estimate_m <= std::max(4 * run.true_m, run.rounding_m) ? 1 : 0;
    if (!shown()) return;
    std::printf("%s: %s asked %.2g, estimate %.2g, true %.2g, rounding %.2g\n", run.name.c_str(),
                to_string(run.told.method).c_str(), run.asked_m, estimate_m, run.true_m, run.rounding_m);
  }
  void refuse(const std::string& name, const InputError& error) {
    ++refused;
    if (shown()) std::printf("%s refused: %s\n", name.c_str(), error.what());
  }
  void judge_cost(const sil::Accuracy& choice, const std::vector<sil::MethodTrial>& trials) {
    ++compared;
    const bool dear = std::ranges::any_of(
        trials, [&](const sil::MethodTrial& trial) { return trial.holds && choice.cost_s > 2 * trial.cost_s; });
    cheap += dear ? 0 : 1;
    if (dear && shown()) std::printf("a dear choice:\n");
  }
  void print(const char* what) const {
    std::printf(
        "%s: %ld judged (%ld refused, %ld without a truth): held %ld, error at most twice the estimate %ld, estimate "
        "at "
        "most four times the error or at rounding %ld; cheap %ld of %ld\n",
        what, judged, refused, unjudged, held, bounded, tight, cheap, compared);
  }
  void expect_kept() const {
    const auto share = [](double percent, long of) {
      return static_cast<long>(std::floor(percent / 100 * static_cast<double>(of)));
    };
    EXPECT_GE(held, share(99, judged));
    EXPECT_GE(bounded, share(99, judged));
    EXPECT_GE(tight, share(90, judged));
    EXPECT_EQ(cheap, compared);
  }
};

// One accuracy for each number, spread evenly over decades.
double accuracy_share(long number) {
  std::mt19937_64 random{static_cast<std::uint64_t>(number) + 1};
  return std::pow(10.0, -1 - 9 * std::ldexp(static_cast<double>(random() >> 11), -53));
}

void judge_machine(long number, Tally& tally) {
  const RandomMachine random = random_machine(number);
  // Half of these are refused by every method.
  if (random.family == Family::stiff_springs || random.family == Family::non_normal) return;
  const ReferenceRun truth = run_reference<Quad>(random.machine, random.start, random.end_s, 2e6);
  if (truth.end != ReferenceEnd::at_rest && truth.end != ReferenceEnd::time_up) {
    ++tally.unjudged;
    return;
  }
  scenario::MachineScenario s;
  s.file = std::to_string(number);
  s.machine = random.machine;
  s.start = random.start;
  s.duration_s = random.end_s;
  s.accuracy_m = accuracy_share(number) * truth.greatest_q;
  if (!(*s.accuracy_m > 0)) return;
  const std::string name = std::to_string(number) + " " + std::string{to_string(random.family)};
  try {
    const sil::MachineResult result = sil::run_machine(s);
    double true_m = 0;
    for (Eigen::Index i = 0; i < result.outcome.end.q.size(); ++i) {
      true_m = std::max(
          true_m, static_cast<double>(magnitude(Quad(result.outcome.end.q[i]) - truth.q[static_cast<std::size_t>(i)])));
    }
    tally.judge({name, *result.accuracy, *s.accuracy_m, true_m, 1e-12 * truth.greatest_q});
    if (number % 8 == 0) tally.judge_cost(*result.accuracy, sil::try_methods(s));
  } catch (const InputError& error) {
    tally.refuse(name, error);
  }
}

TEST(AccuracyCampaign, MachinesMakeTheErrorThatTheyTell) {
  const long first = from_environment("BREAKAWAY_FIRST_SYSTEM", 0), count = from_environment("BREAKAWAY_SYSTEMS", 100);
  Tally tally;
  for (long number = first; number < first + count; ++number) judge_machine(number, tally);
  tally.print("machines");
  tally.expect_kept();
}

// --- axes

model::ShapePtr random_shape(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random() >> 11), -53);
  };
  std::vector<model::ShapePtr> parts;
  parts.push_back(model::shape::stribeck(uniform(0.1, 2)));
  parts.push_back(model::shape::sine_in_time(uniform(1, 20), 0));
  parts.push_back(model::shape::sine_in_position(uniform(0.05, 1), 0));
  parts.push_back(model::shape::constant(uniform(0, 1)));
  std::shuffle(parts.begin(), parts.end(), random);
  parts.resize(2);
  return model::shape::mean({1, 1}, std::move(parts));
}

// Rigid axes under smooth friction: even numbers ideal, odd ones on the bus, every second of these with a lag.
scenario::Scenario random_axis(long number) {
  std::mt19937_64 random{static_cast<std::uint64_t>(number)};
  const bool bus = number % 2 == 1;
  const char* file = bus ? "/sim/scenarios/can_axis.toml" : "/sim/scenarios/impulsive_example.toml";
  scenario::Scenario s = scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR} + file);
  scenario::AxisWorld& world = s.worlds.front();
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random() >> 11), -53);
  };
  world.position_m = uniform(-1, 1) * (bus ? 0.5 : 5);
  world.velocity_m_s = bus ? 0 : uniform(-4, 4);
  world.friction = {s.node.axes.front().friction.bounds, random_shape(random)};
  if (bus && number % 4 == 1) world.drive->current_loop_time_constant_s = 0;
  s.run->duration_s = bus ? 1 : 30;
  s.run->accuracy_m = accuracy_share(number);
  return s;
}

double true_error_m(const scenario::Scenario& s, const sil::AxisResult& axis) {
  const std::vector<double> positions_m = sil::compared_positions_m(axis, s.ideal());
  const auto truth_m = s.ideal() ? true_kicks_m(s, positions_m.size()) : true_way_m(s, positions_m.size());
  double largest_m = 0;
  for (std::size_t i = 0; i < std::min(positions_m.size(), truth_m.size()); ++i) {
    largest_m = std::max(largest_m, std::abs(positions_m[i] - truth_m[i]));
  }
  return largest_m;
}

void judge_axis(long number, Tally& tally) {
  const scenario::Scenario s = random_axis(number);
  const std::string name = "axis " + std::to_string(number);
  try {
    const sil::Result result = sil::run_scenario(s, {.trace = !s.ideal()});
    tally.judge({name, *result.accuracy, *s.run->accuracy_m, true_error_m(s, result.axes.front()), 1e-11});
    if (number % 8 < 2) tally.judge_cost(*result.accuracy, sil::try_methods(s));
  } catch (const InputError& error) {
    tally.refuse(name, error);
  }
}

TEST(AccuracyCampaign, AxesMakeTheErrorThatTheyTell) {
  const long first = from_environment("BREAKAWAY_FIRST_AXIS", 0), count = from_environment("BREAKAWAY_AXES", 20);
  Tally tally;
  for (long number = first; number < first + count; ++number) judge_axis(number, tally);
  tally.print("axes");
  tally.expect_kept();
}

}  // namespace
