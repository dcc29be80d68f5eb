// Theorems S and U against simulation, on many random machines of axes that push each other. Each trial depends on its
// number only, so that any one of them can be run again:
//   BREAKAWAY_KICKS=20000 BREAKAWAY_MACHINES=1000 tests/campaign/coupled_campaign_test
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "breakaway/design/coordinator.hpp"
#include "breakaway/law/coordinator_parameters.hpp"
#include "breakaway/law/kick_coordinator.hpp"
#include "breakaway/stability/machine_certificate.hpp"
#include "environment.hpp"
#include "random_coupled_axes.hpp"

namespace {

using namespace breakaway;
using namespace breakaway::campaign;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double step_s = 1e-6;
constexpr double slip_m = 2e-9;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// One kick of axis i towards 0 from rest, as Theorem S has it.
struct Kick {
  Index axis = 0;
  double force_N = 0;
  int periods = 1;
};

struct KickOutcome {
  double slip_m = 0;    // the most that another axis moved
  double beyond_m = 0;  // by which the kicked axis passed its target
  double travel_m = 0;
};

void command(CoupledPlant& plant, const stability::CoupledAxes& told, const Kick& kick, double direction,
             double force_N, double held_N) {
  for (Index j = 0; j < told.axes(); ++j) {
    const double share = told.actuated(j) ? stability::coupling(told, kick.axis, j).hold_off : 0;
    plant.command_N[at(j)] = direction * share * held_N;
  }
  plant.command_N[at(kick.axis)] = direction * force_N;
}

KickOutcome follow(const CoupledDraw& d, const Kick& kick, const Forces& start, AnyFriction& friction) {
  const stability::KickedAxis k = stability::kicked_axis(d.told, d.box_m, kick.axis);
  CoupledPlant plant{d.truth};
  plant.q = start;
  const double direction = start[at(kick.axis)] > 0 ? -1 : 1;
  const double pulse_s = kick.periods * d.told.period_s;
  const double coast_s = (kick.force_N - k.lower_N) * pulse_s / (k.lower_N + k.brake_N) + 8 * d.told.lag_s + 1e-3;
  KickOutcome outcome;
  const auto run = [&](double from_s, double to_s) {
    const long steps = std::lround((to_s - from_s) / step_s);
    for (long n = 0; n < steps; ++n) {
      friction.set(plant.friction_N, from_s + static_cast<double>(n) * step_s, kick.axis);
      plant.step(step_s);
      for (Index j = 0; j < d.told.axes(); ++j) {
        if (j != kick.axis) outcome.slip_m = std::max(outcome.slip_m, std::abs(plant.q[at(j)] - start[at(j)]));
      }
      outcome.beyond_m = std::max(outcome.beyond_m, plant.q[at(kick.axis)] * direction);
    }
  };
  command(plant, d.told, kick, direction, kick.force_N, kick.force_N - (k.lower_N + k.upper_N) / 2);
  run(0, pulse_s);
  command(plant, d.told, kick, direction, -k.brake_N, -(k.upper_N + k.brake_N) / 2);
  run(pulse_s, pulse_s + coast_s);
  outcome.travel_m = std::abs(plant.q[at(kick.axis)] - start[at(kick.axis)]);
  return outcome;
}

struct Tally {
  long trials = 0, slips = 0, beyond = 0, short_of_promise = 0;
  double worst_slip_m = 0, worst_beyond_m = 0;

  void add(const KickOutcome& outcome, double promised_m) {
    ++trials;
    slips += outcome.slip_m > slip_m;
    beyond += outcome.beyond_m > slip_m;
    short_of_promise += outcome.travel_m < promised_m - slip_m;
    worst_slip_m = std::max(worst_slip_m, outcome.slip_m);
    worst_beyond_m = std::max(worst_beyond_m, outcome.beyond_m);
  }
};

// The machine of a trial, and a kick of it inside the theorem's conditions or beyond them; false: it has none.
bool trial(long number, bool inside, const Kind& kind, Tally& tally) {
  Dice dice{static_cast<std::uint64_t>(number) * 2 + (inside ? 0 : 1)};
  const Index n = 2 + dice.below(3);
  const CoupledDraw d = random_coupled(dice, kind, n, dice.decades(3e-4, 0.03));
  const Index i = dice.below(static_cast<int>(d.told.actuated(n - 1) ? n : n - 1));
  const stability::KickedAxis k = stability::kicked_axis(d.told, d.box_m, i);
  if (!(k.lower_N > k.brake_N)) return false;
  const double least_N = k.sure_N;
  const double most_N = stability::largest_kick_N(d.told, d.box_m, least_N, d.told.max_force_N[i], i);
  if (inside && most_N == 0) return false;
  const double top_N = inside ? most_N : d.told.max_force_N[i];
  if (!(top_N >= least_N)) return false;
  Kick kick{i, inside && dice.chance(0.5) ? top_N : dice.decades(least_N, top_N), 1 + dice.below(8)};
  const double y_m = k.most_travel_m(kick.force_N, kick.periods * d.told.period_s);
  const stability::PairCondition worst = stability::tightest(d.told, d.box_m, kick.force_N, i);
  // What is outside of the condition is so clearly, and all of it is in the box.
  if (y_m > d.box_m[i] || worst.holds() != inside) return false;
  if (!inside && (worst.needed_N < 1.05 * worst.held_N || worst.phase == stability::KickPhase::hold_off)) return false;
  Forces start{};
  for (Index j = 0; j < n; ++j) start[at(j)] = dice.between(-1, 1) * d.box_m[j];
  start[at(i)] = dice.sign() * y_m;
  AnyFriction friction{dice, d.told, inside ? dice.below(AnyFriction::kinds) : 2 + dice.below(3)};
  const KickOutcome outcome = follow(d, kick, start, friction);
  tally.add(outcome, inside ? k.least_travel_m(kick.force_N, kick.periods * d.told.period_s) : 0);
  if (inside && (outcome.slip_m > slip_m || outcome.beyond_m > slip_m))
    std::printf("trial %ld, %s: slip %.3g m, beyond %.3g m\n", number, kind.name, outcome.slip_m, outcome.beyond_m);
  return true;
}

// So many numbers are drawn at most for each machine that is wanted that no two parts of a campaign draw the same.
long first_drawn() { return 100 * from_environment("BREAKAWAY_FIRST_MACHINE", 0); }

Tally campaign(bool inside, const Kind& kind, long wanted) {
  Tally tally;
  const auto place = static_cast<long>(&kind - kinds.data());
  const long first = first_drawn();
  for (long number = first; tally.trials < wanted && number < first + 200 * wanted; ++number)
    trial(number * static_cast<long>(kinds.size()) + place, inside, kind, tally);
  return tally;
}

TEST(CoupledCampaign, InsideTheConditionNoOtherAxisMovesAndOutsideMostDo) {
  const long wanted = from_environment("BREAKAWAY_KICKS", 800) / static_cast<long>(kinds.size());
  std::printf("| machine | inside | slips | beyond | short of the promise | worst slip (m) | outside | slips |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  long outside_trials = 0, outside_slips = 0;
  for (const Kind& kind : kinds) {
    const Tally in = campaign(true, kind, wanted), out = campaign(false, kind, wanted / 3 + 1);
    std::printf("| %s | %ld | %ld | %ld | %ld | %.2g | %ld | %ld |\n", kind.name, in.trials, in.slips, in.beyond,
                in.short_of_promise, in.worst_slip_m, out.trials, out.slips);
    EXPECT_EQ(in.trials, wanted) << kind.name;
    EXPECT_EQ(in.slips, 0) << kind.name;
    EXPECT_EQ(in.beyond, 0) << kind.name;
    EXPECT_EQ(in.short_of_promise, 0) << kind.name;
    outside_trials += out.trials, outside_slips += out.slips;
  }
  EXPECT_GE(2 * outside_slips, outside_trials);
}

// A machine with a sampled approach, as a node has it.
struct Machine {
  CoupledDraw draw;
  stability::SampledApproach approach;
  VectorXd tolerance_m;
};

Machine random_machine(Dice& dice, const Kind& kind) {
  const Index n = 2 + dice.below(2);
  const double start_m = dice.decades(5e-3, 0.1);
  Machine m{random_coupled(dice, kind, n, 0.05), {}, {}};
  stability::CoupledAxes& a = m.draw.told;
  a.period_s = dice.chance(0.5) ? 1e-3 : 5e-4;
  a.force_step_N = VectorXd::Constant(n, dice.chance(0.5) ? 0 : 0.01);
  if (a.lag_s > 0) m.draw.truth.lag_s = a.lag_s = 0.1 * a.period_s;
  if (kind.springs) a.stiffness *= 0.02 / 0.2 * 10, m.draw.truth.stiffness = square_of(a.stiffness);
  m.approach.position_gain_N_per_m.resize(n), m.approach.velocity_gain_Ns_per_m.resize(n);
  for (Index i = 0; i < n; ++i) {
    const double rate = dice.between(6, 25);
    m.approach.position_gain_N_per_m[i] = a.mass(i, i) * rate * rate;
    m.approach.velocity_gain_Ns_per_m[i] = dice.between(0.5, 1) * a.mass(i, i) * rate;
  }
  m.approach.start_m = VectorXd::Constant(n, start_m);
  m.approach.resolution_m = VectorXd::Constant(n, 1e-6);
  m.tolerance_m = VectorXd::Constant(n, dice.decades(2e-5, 2e-4));
  return m;
}

struct RunOutcome {
  bool held = false;
  std::uint32_t kicks = 0;
  double time_s = 0, slip_m = 0, beyond_m = 0, error_m = 0;
  const char* fault = "none";
};

// The coordinator that is flashed, on the plant, a sample and its force a period apart.
template <class Real>
class SampledRun {
 public:
  using Coordinator = law::KickCoordinator<Real, most_axes>;

  SampledRun(const Machine& machine, const law::CoordinatorParameters<Real, most_axes>& parameters, Dice& dice)
      : m_{machine},
        plant_{machine.draw.truth},
        coordinator_{parameters},
        friction_{dice, machine.draw.told, dice.below(AnyFriction::kinds)} {
    for (Index i = 0; i < axes(); ++i) plant_.q[at(i)] = dice.between(-1, 1) * m_.approach.start_m[i];
  }

  RunOutcome run(double patience_s) {
    const double period_s = m_.draw.told.period_s;
    while (outcome_.time_s < patience_s && coordinator_.phase() != law::CoordinatorPhase::hold &&
           coordinator_.fault() == law::ControlFault::none) {
      const Forces sampled = plant_.q;
      plant_.command_N = next_;
      ask(sampled);
      move(period_s);
      outcome_.time_s += period_s;
    }
    outcome_.held =
        coordinator_.phase() == law::CoordinatorPhase::hold && coordinator_.end() == law::CoordinatorEnd::on_target;
    outcome_.kicks = coordinator_.kicks();
    outcome_.fault = to_string(coordinator_.fault()).data();
    for (Index i = 0; i < axes(); ++i)
      outcome_.error_m =
          std::max(outcome_.error_m, std::abs(plant_.q[at(i)]) - m_.tolerance_m[i] - m_.approach.resolution_m[i] / 2);
    return outcome_;
  }

 private:
  Index axes() const { return m_.draw.told.axes(); }

  void ask(const Forces& sampled) {
    for (Index i = 0; i < axes(); ++i) {
      const double count_m = m_.approach.resolution_m[i], step_N = m_.draw.told.force_step_N[i];
      const double reading_m = std::round(sampled[at(i)] / count_m) * count_m;
      const auto output = coordinator_.update(at(i), {static_cast<Real>(reading_m), Real{0}, true});
      const auto force_N = static_cast<double>(output.force_N);
      next_[at(i)] = step_N > 0 ? std::round(force_N / step_N) * step_N : force_N;
      if (output.kicked) begin_kick(i);
    }
  }

  void begin_kick(Index i) {
    watched_ = i;
    before_ = plant_.q;
  }

  void move(double period_s) {
    constexpr double fine_s = 2e-6;
    const long steps = std::lround(period_s / fine_s);
    for (long n = 0; n < steps; ++n) {
      friction_.set(plant_.friction_N, outcome_.time_s + static_cast<double>(n) * fine_s, watched_);
      plant_.step(fine_s);
    }
    if (watched_ < 0) return;
    for (Index j = 0; j < axes(); ++j) {
      const double moved_m = std::abs(plant_.q[at(j)] - before_[at(j)]);
      const double side = before_[at(j)] > 0 ? -1 : 1;
      if (j != watched_) outcome_.slip_m = std::max(outcome_.slip_m, moved_m);
      if (j == watched_) outcome_.beyond_m = std::max(outcome_.beyond_m, side * plant_.q[at(j)]);
    }
  }

  const Machine& m_;
  CoupledPlant plant_;
  Coordinator coordinator_;
  AnyFriction friction_;
  Forces next_{}, before_{};
  Index watched_ = -1;
  RunOutcome outcome_;
};

struct Certified {
  long drawn = 0, runs = 0, failures = 0;
  std::vector<double> times_s;
  std::vector<std::uint32_t> kicks;
  double largest_share_of_kicks = 0;
};

bool fails(const RunOutcome& r, std::uint32_t most_kicks) {
  return !r.held || r.slip_m > slip_m || r.beyond_m > slip_m || r.error_m > 0 || r.kicks > most_kicks;
}

// False where the machine is not certified.
bool run_certified(long number, const Kind& kind, Certified& all) {
  Dice dice{static_cast<std::uint64_t>(number) + 1'000'000};
  const Machine m = random_machine(dice, kind);
  const auto certificate = stability::certify_machine(m.draw.told, m.approach, m.tolerance_m);
  ++all.drawn;
  if (!certificate.certified) return false;
  const auto parameters =
      design::coordinator_parameters<float, most_axes>(m.draw.told, m.approach, m.tolerance_m, certificate);
  SampledRun<float> run{m, parameters, dice};
  const RunOutcome r = run.run(60);
  ++all.runs;
  all.times_s.push_back(r.time_s);
  all.kicks.push_back(r.kicks);
  all.largest_share_of_kicks =
      std::max(all.largest_share_of_kicks, 1.0 * r.kicks / std::max(1U, certificate.most_kicks));
  if (!fails(r, certificate.most_kicks)) return true;
  ++all.failures;
  std::printf("machine %ld, %s: held %d, fault %s, %u of %u kicks, slip %.3g m, beyond %.3g m, error %.3g m\n", number,
              kind.name, r.held ? 1 : 0, r.fault, r.kicks, certificate.most_kicks, r.slip_m, r.beyond_m, r.error_m);
  return true;
}

template <class Value>
double median(std::vector<Value> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

TEST(CoupledCampaign, ACertifiedMachineReachesItsTargetsUnderEveryFriction) {
  const long wanted = from_environment("BREAKAWAY_MACHINES", 24) / 6;
  std::printf(
      "| machine | drawn | certified | failures | median time (s) | worst | median kicks | worst | of those promised "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  for (const std::size_t place : {0UL, 2UL, 3UL, 5UL, 6UL, 7UL}) {
    const Kind& kind = kinds[place];
    Certified all;
    const long first = first_drawn();
    for (long number = first; all.runs < wanted && number < first + 400 * wanted; ++number)
      run_certified(number * 8 + static_cast<long>(place), kind, all);
    std::printf("| %s | %ld | %ld | %ld | %.2f | %.2f | %.0f | %u | at most %.0f %% |\n", kind.name, all.drawn,
                all.runs, all.failures, median(all.times_s),
                all.times_s.empty() ? 0 : *std::ranges::max_element(all.times_s), median(all.kicks),
                all.kicks.empty() ? 0 : *std::ranges::max_element(all.kicks), 100 * all.largest_share_of_kicks);
    EXPECT_EQ(all.runs, wanted) << kind.name;
    EXPECT_EQ(all.failures, 0) << kind.name;
  }
}

}  // namespace
