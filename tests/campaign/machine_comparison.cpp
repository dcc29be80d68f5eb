#include "machine_comparison.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::campaign {
namespace {

using hybrid::Verdict;
using Outcome = hybrid::Outcome<Eigen::Dynamic>;

constexpr double event_driven_error = 1e-10;
constexpr double tie_width = 2e-12;  // twice what the methods give to static friction

struct Endless : std::runtime_error {
  Endless() : std::runtime_error{"more steps than the campaign allows"} {}
};

class StepLimit {
 public:
  explicit StepLimit(std::uint64_t most) : left_{most} {}
  void operator()(const State&) {
    if (left_-- == 0) throw Endless{};
  }

 private:
  std::uint64_t left_;
};

// The largest difference of a coordinate and of a speed, each as a share of the greatest that was met.
double difference(const State& state, const ReferenceRun& reference) {
  Quad worst = 0;
  for (std::size_t i = 0; i < reference.q.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const Quad q = magnitude(Quad(state.q[at]) - reference.q[i]), v = magnitude(Quad(state.v[at]) - reference.v[i]);
    if (q > 0) worst = larger(worst, q / larger(Quad(reference.greatest_q), Quad(1e-300)));
    if (v > 0) worst = larger(worst, v / larger(Quad(reference.greatest_v), Quad(1e-300)));
  }
  return static_cast<double>(worst);
}

bool finite(const State& state) { return state.q.allFinite() && state.v.allFinite() && std::isfinite(state.time_s); }

bool answered(const ReferenceRun& run) { return run.end == ReferenceEnd::at_rest || run.end == ReferenceEnd::time_up; }

// The same machine with its input changed within rounding, or its static friction within the width of a tie.
RandomMachine varied(RandomMachine random, int variant, double amount) {
  if (variant < 2) {
    random.machine.friction_N *= 1 + (variant == 0 ? amount : -amount);
    return random;
  }
  for (Eigen::Index i = 0; i < random.start.q.size(); ++i) {
    const double sign = (variant >> (i % 8) & 1) != 0 ? 1 : -1;
    random.start.q[i] *= 1 + sign * amount;
    random.start.v[i] *= 1 - sign * amount;
  }
  return random;
}

// How far one variant's answer is, and how far the variants are from each other.
struct Sensitivity {
  double nearest, spread;
};

Sensitivity sensitivity(const RandomMachine& random, const ReferenceRun& reference, const State& state, double amount,
                        double most_work) {
  Sensitivity result{difference(state, reference), 0};
  for (int variant = 0; variant < 6; ++variant) {
    const RandomMachine other = varied(random, variant, amount);
    const ReferenceRun run = run_reference<Quad>(other.machine, other.start, other.end_s, most_work);
    if (!answered(run)) continue;
    result.nearest = std::min(result.nearest, difference(state, run));
    State end{0, Eigen::VectorXd(state.q.size()), Eigen::VectorXd(state.q.size())};
    for (std::size_t i = 0; i < run.q.size(); ++i) {
      end.q[static_cast<Eigen::Index>(i)] = static_cast<double>(run.q[i]);
      end.v[static_cast<Eigen::Index>(i)] = static_cast<double>(run.v[i]);
    }
    result.spread = std::max(result.spread, difference(end, reference));
  }
  return result;
}

// Ends the process when so many more seconds of processor time have passed in the life of this.
class ProcessorTimeLimit {
 public:
  explicit ProcessorTimeLimit(long seconds) {
    getrlimit(RLIMIT_CPU, &before_);
    if (seconds <= 0) return;
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    const rlimit limit{static_cast<rlim_t>(used.tv_sec + 1 + seconds), before_.rlim_max};
    setrlimit(RLIMIT_CPU, &limit);
  }
  ~ProcessorTimeLimit() { setrlimit(RLIMIT_CPU, &before_); }
  ProcessorTimeLimit(const ProcessorTimeLimit&) = delete;
  ProcessorTimeLimit& operator=(const ProcessorTimeLimit&) = delete;

 private:
  rlimit before_{};
};

Outcome run_event_driven(const RandomMachine& r, const ComparisonOptions& options) {
  const ProcessorTimeLimit limit{options.most_cpu_s};
  const hybrid::EventDriven<> method{r.machine};
  // Its budget ends it, and stiff machines have hundreds of thousands of true events.
  return method.run(r.start, r.end_s, nullptr, StepLimit{std::max<std::uint64_t>(options.most_steps, 2'000'000)});
}

Outcome run_adaptive(const RandomMachine& r, const ComparisonOptions& options) {
  const ProcessorTimeLimit limit{options.most_cpu_s};
  const hybrid::Adaptive method{r.machine, hybrid::AdaptiveOptions{.tolerance = options.tolerance}};
  return method.run(r.start, r.end_s, nullptr, StepLimit{options.most_steps});
}

Outcome run_time_stepping(const RandomMachine& r, double steps, const ComparisonOptions& options) {
  const ProcessorTimeLimit limit{options.most_cpu_s};
  const hybrid::TimeStepping<> method{r.machine, {.step_s = r.end_s / steps, .theta = 0.5}};
  return method.run(r.start, r.end_s);
}

// Rest is seen by both or by none, at the same instant up to a share of the duration. An instant near the end is
// either's.
std::string rest_contradiction(const Outcome& outcome, const ReferenceRun& reference, double end_s, double share) {
  const bool rests = outcome.verdict == Verdict::at_rest, does = reference.end == ReferenceEnd::at_rest;
  const bool settled = rests || outcome.verdict == Verdict::captured;
  if (does && !settled && reference.rest_s < end_s * (1 - 1e-6)) return "rest was missed";
  if (rests && !does && outcome.settling_time_s < end_s * (1 - 1e-6)) {
    const double moving = static_cast<double>(largest(reference.v));
    if (moving > 1e-12 * reference.greatest_v) return "rest was invented";
  }
  if (rests && does && std::abs(outcome.settling_time_s - reference.rest_s) > share * end_s) {
    return "rest began at another instant";
  }
  return {};
}

// Says whether rounding of the input alone moves rest as far as it was missed.
bool rest_is_sensitive(const RandomMachine& random, const ReferenceRun& reference, const Outcome& outcome,
                       double amount, double most_work) {
  const double missed_s = std::abs(outcome.settling_time_s - reference.rest_s);
  for (int variant = 0; variant < 6; ++variant) {
    const RandomMachine other = varied(random, variant, amount);
    const ReferenceRun run = run_reference<Quad>(other.machine, other.start, other.end_s, most_work);
    if (answered(run) && std::abs(run.rest_s - reference.rest_s) >= missed_s / 10) return true;
  }
  return false;
}

Judgement judge_end(const RandomMachine& r, const ReferenceRun& reference, const Outcome& outcome, double allowed,
                    double amount, double most_work) {
  Judgement result;
  if (!finite(outcome.end)) return {Finding::not_a_number, 0, "the state at the end"};
  if (!answered(reference)) return {Finding::unjudged, 0, "the reference has no answer"};
  result.error = difference(outcome.end, reference);
  if (!(result.error <= allowed)) {
    const Sensitivity s = sensitivity(r, reference, outcome.end, amount, most_work);
    const bool tie = s.nearest <= allowed, condition = s.spread > allowed / 10 && result.error <= 10 * s.spread;
    result.finding = tie || condition ? Finding::sensitive : Finding::wrong;
    return result;
  }
  // The instant of a stop depends on the root of what is left of the motion.
  result.note = rest_contradiction(outcome, reference, r.end_s, std::sqrt(allowed));
  if (result.note.empty()) {
    result.finding = Finding::right;
  } else {
    const bool tie = rest_is_sensitive(r, reference, outcome, amount, most_work);
    result.finding = tie ? Finding::sensitive : Finding::other_rest;
  }
  return result;
}

// Where the reference was not given enough work, the two exact methods have to agree with each other.
Judgement judge_agreement(const RandomMachine& r, const Outcome& adaptive, const ComparisonOptions& options) {
  if (!finite(adaptive.end)) return {Finding::not_a_number, 0, "the state at the end"};
  const Outcome other = run_event_driven(r, options);
  const double q = std::max(r.start.q.cwiseAbs().maxCoeff(), other.end.q.cwiseAbs().maxCoeff());
  const double v = std::max(r.start.v.cwiseAbs().maxCoeff(), other.end.v.cwiseAbs().maxCoeff());
  const double apart = std::max((adaptive.end.q - other.end.q).cwiseAbs().maxCoeff() / std::max(q, 1e-300),
                                (adaptive.end.v - other.end.v).cwiseAbs().maxCoeff() / std::max(v, 1e-300));
  return {apart <= 100 * options.tolerance ? Finding::agreed : Finding::unjudged, apart, "from event-driven"};
}

// How far the method's end is from where the reference is at that instant, if both come to rest and the method does so
// first; infinite if not.
double difference_when_it_rests(const RandomMachine& random, const ReferenceRun& reference, const Outcome& outcome,
                                double most_work) {
  constexpr double none = std::numeric_limits<double>::infinity();
  if (outcome.verdict != Verdict::at_rest || reference.end != ReferenceEnd::at_rest) return none;
  if (outcome.settling_time_s > reference.rest_s) return none;
  ReferenceRun then = run_reference<Quad>(random.machine, random.start, outcome.settling_time_s, most_work);
  then.greatest_q = reference.greatest_q;
  then.greatest_v = reference.greatest_v;
  return answered(then) ? difference(outcome.end, then) : none;
}

// Says whether the reference rests as well, and from the earlier rest of the method on moves by less than a tenth of
// the tolerance. A method whose steps are exact to its tolerance cannot tell so small a swing from rest, and the state
// that it answers with is right at either instant.
bool swings_within_tolerance(const RandomMachine& random, const ReferenceRun& reference, const Outcome& outcome,
                             const ComparisonOptions& options) {
  return difference_when_it_rests(random, reference, outcome, options.most_work) <= options.tolerance / 10;
}

// Says whether the reference, begun where the method rests, rests there at once, and what is left of the true motion is
// rounding of that state: a creep that has died out, and moves what friction hardly holds.
bool rests_within_rounding(const RandomMachine& random, const ReferenceRun& reference, const Outcome& outcome,
                           double most_work) {
  constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
  if (!(difference_when_it_rests(random, reference, outcome, most_work) <= rounding)) return false;
  const ReferenceRun onwards = run_reference<Quad>(random.machine, outcome.end, random.end_s, most_work);
  return onwards.end == ReferenceEnd::at_rest && onwards.rest_s == outcome.end.time_s;
}

// Agrees with the reference on the processor's own numbers, with room for what rounding makes of these.
bool acquitted(const Outcome& outcome, const ReferenceRun& fast, double end_s, double allowed) {
  return finite(outcome.end) && answered(fast) && difference(outcome.end, fast) <= allowed / 4 &&
         rest_contradiction(outcome, fast, end_s, std::sqrt(allowed) / 4).empty();
}

}  // namespace

std::string_view to_string(Method method) {
  constexpr std::array<std::string_view, methods> names{"event-driven", "adaptive", "time stepping"};
  return names.at(static_cast<std::size_t>(method));
}

std::string_view to_string(Finding finding) {
  constexpr std::array<std::string_view, findings> names{"right", "agreed",     "sensitive", "refused", "unjudged",
                                                         "wrong", "other rest", "NaN",       "endless", "crashed"};
  return names.at(static_cast<std::size_t>(finding));
}

Comparison::Comparison(const RandomMachine& random, ComparisonOptions options) : random_{random}, options_{options} {}

const ReferenceRun& Comparison::fast() {
  if (!fast_) fast_ = run_reference<Fast>(random_.machine, random_.start, random_.end_s, options_.most_work);
  return *fast_;
}

// What takes too long on the processor's numbers rarely ends on these, and is given less.
const ReferenceRun& Comparison::exact() {
  if (!exact_) {
    const double work = options_.most_work * (fast().end == ReferenceEnd::too_long ? 0.05 : 1);
    exact_ = run_reference<Quad>(random_.machine, random_.start, random_.end_s, work);
  }
  return *exact_;
}

Judgement Comparison::judge_event_driven() {
  const Outcome outcome = run_event_driven(random_, options_);
  if (acquitted(outcome, fast(), random_.end_s, event_driven_error)) {
    return {Finding::right, difference(outcome.end, fast()), {}};
  }
  Judgement result = judge_end(random_, exact(), outcome, event_driven_error, tie_width, options_.most_work);
  if (result.finding == Finding::other_rest && rests_within_rounding(random_, exact(), outcome, options_.most_work)) {
    result.finding = Finding::sensitive;
  }
  return result;
}

Judgement Comparison::judge_adaptive() {
  const Outcome outcome = run_adaptive(random_, options_);
  const double allowed = 10 * options_.tolerance;
  if (acquitted(outcome, fast(), random_.end_s, allowed)) return {Finding::right, difference(outcome.end, fast()), {}};
  if (!answered(exact())) return judge_agreement(random_, outcome, options_);
  Judgement result =
      judge_end(random_, exact(), outcome, allowed, std::max(tie_width, options_.tolerance), options_.most_work);
  if (result.finding == Finding::other_rest && swings_within_tolerance(random_, exact(), outcome, options_)) {
    result.finding = Finding::right;
  }
  return result;
}

Judgement Comparison::judge_time_stepping() {
  constexpr double coarse = 500, refinement = 8, resolved = 1e-6;
  const Outcome first = run_time_stepping(random_, coarse, options_),
                second = run_time_stepping(random_, coarse * refinement, options_);
  if (!finite(first.end) || !finite(second.end)) return {Finding::not_a_number, 0, "the state at the end"};
  if (acquitted(second, fast(), random_.end_s, resolved)) return {Finding::right, difference(second.end, fast()), {}};
  if (!answered(exact())) return {Finding::unjudged, 0, "the reference has no answer"};
  const double before = difference(first.end, exact()), after = difference(second.end, exact());
  if (after <= resolved || after <= before / 2) return {Finding::right, after, {}};
  // Before the step resolves the fastest motion, nothing is promised.
  return {Finding::unjudged, after, "not yet in the region of convergence"};
}

Judgement Comparison::judge(Method method) {
  try {
    switch (method) {
      case Method::event_driven:
        return judge_event_driven();
      case Method::adaptive:
        return judge_adaptive();
      case Method::time_stepping:
        return judge_time_stepping();
    }
  } catch (const InputError& error) {
    return {Finding::refused, 0, error.what()};
  } catch (const Endless& error) {
    // The adaptive method takes what steps it must; a short campaign does not wait for them.
    const bool patient = method != Method::adaptive || options_.most_steps >= 1'000'000;
    return {patient ? Finding::endless : Finding::unjudged, 0, error.what()};
  }
  return {};
}

}  // namespace breakaway::campaign
