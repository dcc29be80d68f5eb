#include "breakaway/hybrid/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace breakaway::hybrid {
namespace {

// The tolerances of results; those that they are measured by are this much smaller.
constexpr double coarsest = 1e-4, finest = 2.56e-12, apart = 1.0 / 256, least_tolerance = 1e-14;
// A result is tried with this share of the error that is allowed, as far as errors follow the tolerance.
constexpr double aim = 0.25;

double size_of(const Eigen::VectorXd& vector) { return vector.size() == 0 ? 0 : vector.cwiseAbs().maxCoeff(); }

// The integrations of one machine from one start, at several tolerances.
class Runs {
 public:
  Runs(const LinearMachine<>& machine, const Adaptive::Laws& laws, const Adaptive::State& start, double end_time_s,
       std::uint64_t most_steps)
      : machine_{machine}, laws_{laws}, start_{start}, end_time_s_{end_time_s}, most_steps_{most_steps} {}

  AccurateOutcome at_tolerance(double tolerance) {
    AdaptiveOptions options;
    options.tolerance = tolerance;
    options.most_steps = most_steps_;
    const Adaptive method = laws_.empty() ? Adaptive{machine_, options} : Adaptive{machine_, laws_, options};
    AccurateOutcome result;
    result.tolerance = tolerance;
    result.outcome = method.run(start_, end_time_s_, nullptr, [this](const Adaptive::State& state) {
      largest_m_ = std::max(largest_m_, size_of(state.q));
    });
    steps_ += result.outcome.steps;
    return result;
  }
  std::uint64_t steps() const { return steps_; }

  // Makes `finer` finer where two tolerances lead to the same steps: that says nothing about their error.
  double error_m(const AccurateOutcome& result, AccurateOutcome& finer) {
    const double rounding_m = 16 * std::numeric_limits<double>::epsilon() * largest_m_;
    for (;;) {
      const double apart_m = size_of(result.outcome.end.q - finer.outcome.end.q);
      if (apart_m > rounding_m || finer.tolerance <= least_tolerance) return apart_m + rounding_m;
      finer = at_tolerance(std::max(least_tolerance, apart * finer.tolerance));
    }
  }

 private:
  const LinearMachine<>& machine_;
  const Adaptive::Laws& laws_;
  const Adaptive::State& start_;
  double end_time_s_;
  std::uint64_t most_steps_, steps_ = 0;
  double largest_m_ = 0;
};

[[noreturn]] void refuse(double accuracy_m, double error_m) {
  throw Refused{"an accuracy of " + shown(accuracy_m) +
                    " m cannot be held by the adaptive method, whose result is off by " + shown(error_m) +
                    " m at its finest tolerance",
                "ask for " + shown(2 * error_m) + " m or more, or for a shorter time"};
}

}  // namespace

AccurateOutcome run_to_accuracy(const LinearMachine<>& machine, const Adaptive::Laws& laws,
                                const Adaptive::State& start, double end_time_s, double accuracy_m,
                                std::uint64_t most_steps) {
  if (!(accuracy_m > 0) || !std::isfinite(accuracy_m)) {
    throw InputError{"accuracy_m is " + shown(accuracy_m) + ": give a length above 0"};
  }
  Runs runs{machine, laws, start, end_time_s, most_steps};
  AccurateOutcome result = runs.at_tolerance(coarsest);
  AccurateOutcome finer = runs.at_tolerance(apart * coarsest);
  for (;;) {
    result.error_estimate_m = runs.error_m(result, finer);
    result.steps = runs.steps();
    if (result.error_estimate_m <= accuracy_m) return result;
    if (result.tolerance <= finest) refuse(accuracy_m, result.error_estimate_m);
    const double next = result.tolerance * aim * accuracy_m / result.error_estimate_m;
    const double tolerance = std::max(finest, std::min(next, 0.25 * result.tolerance));
    if (finer.tolerance > 1.0 / 16 * tolerance) finer = runs.at_tolerance(apart * tolerance);
    result = runs.at_tolerance(tolerance);
  }
}

}  // namespace breakaway::hybrid
