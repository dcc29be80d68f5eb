// Random axes under the coast "brake", each certified one run under every kind of friction that its bounds allow, with
// the truth anywhere inside what was told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "breakaway/design/approach_time.hpp"
#include "breakaway/design/kick_promise.hpp"
#include "certified_axis.hpp"
#include "random_braked_axis.hpp"

namespace breakaway::campaign {
namespace {

struct Tally {
  long certified = 0, runs = 0, most_kicks = 0;
  double furthest = 0, longest = 0, latest = 0, passed = 0;  // as shares of what is promised

  void note(const testing::RunEnd& end, const BrakedClass& c, double promised_s) {
    ++runs;
    most_kicks = std::max<long>(most_kicks, end.kicks);
    furthest = std::max(furthest, end.beyond_m / c.reading_error_m());
    if (end.kicks > 0) longest = std::max(longest, (end.time_s - end.first_kick_s) / promised_s);
  }
};

testing::TrueAxis true_axis(const BrakedClass& c, Random& r) {
  return {r.inside(c.mass_kg), r.inside(c.force_gain), r.inside(c.lag_s), r.inside({-c.load_N, c.load_N}),
          c.latency_periods};
}

// Where runs start: of the second kind up to 1000 times as far away as kicks are for, of the third as far away as an
// approach of this speed comes in a hundred thousand periods, of the fourth far away where jitter has a pattern.
enum class Start { as_drawn, far_away, slow, far_away_in_pattern };
constexpr double furthest_m = 2;
constexpr double usual_m_s = 10;

struct CertifiedAxis {
  long number;
  Random r;
  BrakedClass axes;
  design::BrakedDesign<float> design;
  double tolerance_m;
  design::KickPromise promise;
  double max_approach_speed_m_s = usual_m_s;
};

double start_m(Start from, const CertifiedAxis& axis, double share) {
  if (from == Start::as_drawn) return std::min(axis.design.floor_m * std::pow(10, 4 * share), 1.0);
  const double nearest_m = design::kicks_begin_m(axis.design);
  const double most_m = from == Start::slow ? 1e5 * axis.axes.period_s * axis.max_approach_speed_m_s : furthest_m;
  return nearest_m * std::pow(std::clamp(most_m / nearest_m, 1.0, 1000.0), share);
}

// The axes `c` with a random tolerance; nothing where their kicks are not certified.
std::optional<CertifiedAxis> certified(long number, const BrakedClass& c, const Random& random) {
  Random r = random;
  const auto design = design::design_braked_kicks<float>(c);
  if (!design.possible()) return {};
  const double tolerance_m = design.least_tolerance_m * (r.share() < 0.5 ? 1 : r.between(1, 4));
  const design::KickPromise promise{c, design, tolerance_m};
  const int kicks = promise.most_kicks(design::kicks_begin_m(design));
  if (kicks == 0 || kicks > law::KickJudge<float>::most_kicks) return {};
  return CertifiedAxis{number, r, c, design, tolerance_m, promise};
}

// The axis of a number.
std::optional<CertifiedAxis> certified_axis(long number) {
  Random r{static_cast<std::uint64_t>(number)};
  const BrakedClass c = random_axes(r);
  return certified(number, c, r);
}

// An axis of a number that is allowed little more than the least speed. Bounds that hardly differ ask for the least.
std::optional<CertifiedAxis> slow_axis(long number) {
  Random r{static_cast<std::uint64_t>(number) + 3'000'000'000};
  BrakedClass c = random_axes(r);
  if (r.share() < 0.5) c.friction.lower_N = c.friction.upper_N * (1 - r.decades(1e-4, 0.5));
  c.load_N = std::min(c.load_N, c.friction.lower_N / 2);
  auto axis = certified(number, c, r);
  if (!axis) return {};
  const double least_m_s = design::least_approach_speed_m_s(c, axis->design);
  axis->max_approach_speed_m_s = least_m_s * (1 + 1e-6) * (axis->r.share() < 0.5 ? 1 : axis->r.decades(1, 10));
  return axis;
}

// An axis of a number whose loop has jitter.
std::optional<CertifiedAxis> axis_with_jitter(long number) {
  Random r{static_cast<std::uint64_t>(number) + 4'000'000'000};
  BrakedClass c = random_axes(r);
  if (!(c.jitter_s > 0)) c.jitter_s = c.period_s * design::most_jitter * (r.share() < 0.3 ? 1 : r.share());
  return certified(number, c, r);
}

std::optional<CertifiedAxis> axis_of(long number, Start from) {
  if (from == Start::far_away_in_pattern) return axis_with_jitter(number);
  return from == Start::slow ? slow_axis(number) : certified_axis(number);
}

bool approach_gets_on(const CertifiedAxis& axis) {
  return design::least_approach_speed_m_s(axis.axes, axis.design) <= axis.max_approach_speed_m_s;
}

testing::Disturbance disturbance_of(CertifiedAxis& axis, Start from, int kind) {
  using testing::Jitter;
  constexpr Jitter patterns[] = {Jitter::every_other_period, Jitter::every_other_force, Jitter::samples_by_threes};
  testing::Disturbance d = disturbance(axis.axes, axis.r);
  if (from == Start::far_away_in_pattern) d.jitter = patterns[(axis.number + kind) % 3];
  return d;
}

void run(CertifiedAxis& axis, Start from, Tally& tally) {
  const BrakedClass& c = axis.axes;
  const double q = c.encoder_resolution_m, read_m = c.reading_error_m(), tolerance_m = axis.tolerance_m;
  auto p = parameters(c, tolerance_m);
  p.max_approach_speed_m_s = static_cast<float>(axis.max_approach_speed_m_s);
  const law::K3Table<float> unused;
  const double from_m = design::kicks_begin_m(axis.design);
  // Nobody waits longer than this for the kicks, and beside them for the approach.
  const double kicks_s = 20 + 2 * axis.promise.most_s(from_m) + 20 * c.period_s * axis.design.kicks.patient_periods;
  const double surplus_N = c.force_gain.least * c.max_force_N - c.friction.upper_N - c.load_N;
  for (int kind = 0; kind < kinds; ++kind) {
    const testing::TrueAxis truth = true_axis(c, axis.r);
    const double distance_m = start_m(from, axis, axis.r.share());
    const double longest_s = kicks_s + 20 * std::sqrt(2 * distance_m * c.mass_kg.most / surplus_N) +
                             (from == Start::slow ? 20 * distance_m / axis.max_approach_speed_m_s : 0);
    const double side = axis.r.share() < 0.5 ? 1 : -1;
    const Friction friction = friction_of_kind(kind, c, static_cast<std::uint64_t>(axis.number * kinds + kind),
                                               std::max(3 * axis.design.floor_m, q), tolerance_m);
    // The target is a count. Where the tolerance is less than one, the places of the counts matter.
    const double encoder_offset = tolerance_m < q ? 0 : axis.r.between(-0.5, 0.5);
    const auto end =
        testing::run_kicked_axis<float>(p, unused, axis.design.kicks, truth, friction, side * distance_m, 0, longest_s,
                                        4, 50, encoder_offset, {}, disturbance_of(axis, from, kind));
    const double first_m = std::max(end.first_kick_m, tolerance_m);
    const double promised_s = axis.promise.most_s(first_m) + static_cast<double>(end.lost_samples) * c.period_s;
    tally.note(end, c, promised_s);
    const double approach_s = design::approach_s(c, axis.design, axis.max_approach_speed_m_s, distance_m);
    const double begun_s = end.kicks > 0 ? end.first_kick_s : end.time_s;
    tally.latest = std::max(tally.latest, begun_s / approach_s);
    const std::string where = "axis " + std::to_string(axis.number) + ", friction " + std::to_string(kind);
    EXPECT_EQ(end.fault, law::ControlFault::none) << where << ": " << to_string(end.fault);
    EXPECT_TRUE(end.held) << where << ": " << end.kicks << " kicks, error " << end.error_m;
    EXPECT_FALSE(end.moving_in_hold) << where;
    EXPECT_LE(std::fabs(end.error_m), (tolerance_m + read_m) * (1 + 1e-6)) << where;
    EXPECT_LE(end.beyond_m, read_m * (1 + 1e-6)) << where;
    EXPECT_LE(end.kicks, axis.promise.most_kicks(first_m)) << where;
    EXPECT_LE(end.first_kick_m, from_m + read_m * (1 + 1e-6)) << where;
    EXPECT_LE(end.kicks > 0 ? end.time_s - end.first_kick_s : 0, promised_s) << where;
    EXPECT_LE(begun_s, approach_s) << where;
    const double approach_beyond_m = design::approach_beyond_m(c, axis.design, axis.max_approach_speed_m_s) + read_m;
    tally.passed = std::max(tally.passed, end.approach_beyond_m / approach_beyond_m);
    EXPECT_LE(end.approach_beyond_m, approach_beyond_m) << where;
  }
}

void run_all(Start from, long first, long axes) {
  Tally tally;
  for (long number = first; number < first + axes; ++number) {
    auto axis = axis_of(number, from);
    if (!axis || !approach_gets_on(*axis)) continue;
    ++tally.certified;
    if (from == Start::as_drawn || design::kicks_begin_m(axis->design) < furthest_m) run(*axis, from, tally);
  }
  constexpr const char* says[] = {"", " from far away", " at little more than the least speed",
                                  " from far away under jitter in a pattern"};
  std::printf(
      "%ld of %ld axes certified, %ld runs%s, at most %ld kicks, %.3f of what may be beyond, %.3f of the time "
      "promised, %.3f of that of the approach, %.3f of its way beyond the target\n",
      tally.certified, axes, tally.runs, says[static_cast<std::size_t>(from)], tally.most_kicks, tally.furthest,
      tally.longest, tally.latest, tally.passed);
  EXPECT_GE(tally.certified, axes / 2);
}

TEST(BrakedCampaign, EveryCertifiedAxisKeepsItsPromise) {
  run_all(Start::as_drawn, asked_for("BREAKAWAY_FIRST_AXIS", 0), asked_for("BREAKAWAY_BRAKED_AXES", 400));
}

TEST(BrakedCampaign, EveryCertifiedAxisKeepsItsPromiseFromFarAway) {
  run_all(Start::far_away, asked_for("BREAKAWAY_FIRST_AXIS", 0), asked_for("BREAKAWAY_FAR_AXES", 60));
}

TEST(BrakedCampaign, EveryCertifiedAxisKeepsItsPromiseAtLittleMoreThanItsLeastSpeed) {
  run_all(Start::slow, asked_for("BREAKAWAY_FIRST_AXIS", 0), asked_for("BREAKAWAY_SLOW_AXES", 20));
}

TEST(BrakedCampaign, EveryCertifiedAxisKeepsItsPromiseFromFarAwayUnderJitterInAPattern) {
  run_all(Start::far_away_in_pattern, asked_for("BREAKAWAY_FIRST_AXIS", 0), asked_for("BREAKAWAY_PATTERNED_AXES", 20));
}

// The target moves once: in the approach or between kicks, by what kicks are for or by as much as the axis is away.
testing::Retarget random_retarget(const CertifiedAxis& axis, double distance_m, double approach_s, Random& r) {
  const double soon_s = axis.axes.period_s * r.decades(1, 300), late_s = approach_s * r.decades(0.1, 10);
  const double near_m = design::kicks_begin_m(axis.design) * r.decades(0.01, 3), far_m = distance_m * 2 * r.share();
  const double way_m = std::min(r.share() < 0.7 ? near_m : far_m, furthest_m);
  return {r.share() < 0.5 ? soon_s : late_s, r.share() < 0.5 ? way_m : -way_m};
}

void run_retargeted(CertifiedAxis& axis, Random& r) {
  const BrakedClass& c = axis.axes;
  const double q = c.encoder_resolution_m, tolerance_m = axis.tolerance_m;
  const law::K3Table<float> unused;
  const double kicks_s = 20 + 4 * axis.promise.most_s(design::kicks_begin_m(axis.design)) +
                         40 * c.period_s * axis.design.kicks.patient_periods;
  const double surplus_N = c.force_gain.least * c.max_force_N - c.friction.upper_N - c.load_N;
  for (int kind = 0; kind < kinds; ++kind) {
    const testing::TrueAxis truth = true_axis(c, r);
    const double distance_m = start_m(Start::as_drawn, axis, r.share());
    const double approach_s = std::sqrt(2 * distance_m * c.mass_kg.most / surplus_N);
    const testing::Retarget retarget = random_retarget(axis, distance_m, approach_s, r);
    const double longest_s = retarget.at_s + kicks_s + 20 * approach_s +
                             20 * std::sqrt(2 * std::fabs(retarget.shift_m) * c.mass_kg.most / surplus_N);
    const Friction friction = friction_of_kind(kind, c, static_cast<std::uint64_t>(axis.number * kinds + kind),
                                               std::max(3 * axis.design.floor_m, q), tolerance_m);
    const auto end =
        testing::run_kicked_axis<float>(parameters(c, tolerance_m), unused, axis.design.kicks, truth, friction,
                                        r.share() < 0.5 ? distance_m : -distance_m, 0, longest_s, 4, 50,
                                        tolerance_m < q ? 0 : r.between(-0.5, 0.5), retarget, disturbance(c, r));
    const std::string where = "axis " + std::to_string(axis.number) + ", friction " + std::to_string(kind);
    EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault) << ", error " << end.error_m;
    EXPECT_FALSE(end.moving_in_hold) << where;
    // The target is a float as well.
    const double rounding_m = 2 * std::fabs(retarget.shift_m) * std::numeric_limits<float>::epsilon();
    EXPECT_LE(std::fabs(end.error_m), (tolerance_m + c.reading_error_m()) * (1 + 1e-6) + rounding_m) << where;
  }
}

TEST(BrakedCampaign, EveryCertifiedAxisSettlesWhereItsTargetMovesOnTheWay) {
  const long first = asked_for("BREAKAWAY_FIRST_AXIS", 0), axes = asked_for("BREAKAWAY_RETARGETED_AXES", 60);
  for (long number = first; number < first + axes; ++number) {
    auto axis = certified_axis(number);
    Random r{static_cast<std::uint64_t>(number) + 2'000'000'000};
    if (axis && approach_gets_on(*axis)) run_retargeted(*axis, r);
  }
}

struct CounterExample {
  long number;
  Start from;
  const char* what_was_wrong;
};

constexpr CounterExample counter_examples[] = {
    {264, Start::as_drawn, "failed before jitter and noise were certified; why is not on record"},
    {427, Start::as_drawn, "failed before jitter and noise were certified; why is not on record"},
    {1203, Start::as_drawn, "failed before jitter and noise were certified; why is not on record"},
    {1393, Start::as_drawn, "failed before jitter and noise were certified; why is not on record"},
    {10979, Start::as_drawn, "a pulse from more force than the brake's goes beyond"},
    {11374, Start::as_drawn, "creeps in the approach without end"},
    {18015, Start::as_drawn, "creeps in the approach without end"},
    {27927, Start::as_drawn, "its current loop still brakes hard as the axis turns, further away than kicks are for"},
    {301425, Start::as_drawn, "4 t under 1 N take 50 s for 95 mm"},
    {307705, Start::as_drawn, "taken for arrived on its way back, further away than kicks are for"},
    {405828, Start::as_drawn, "heavy and slow at first, taken for one that creeps, and out of kicks"},
    {407106, Start::as_drawn, "driven to and fro, and released at 5 m/s"},
    {1003510, Start::as_drawn,
     "its drive knows one force that is hardly above friction: taken for stuck as it set out"},
    {1066736, Start::as_drawn, "its drive knows two forces, the greater hardly above friction: taken for stuck"},
    {1109211, Start::as_drawn,
     "a pulse of a hundred periods within one count, after which it was held as it still moved"},
    {8089988, Start::as_drawn,
     "creeps on for 12 s, by friction that steers it, and its plan expects to turn now and then"},
    {30207351, Start::as_drawn, "its preload is rounded to a step less than a pulse may start from, and waits in vain"},
    {10099504, Start::as_drawn, "noise hides until late that it moved, and its proof of rest begins anew"},
    {10024422, Start::as_drawn, "passes its target as the sample is lost in which it was to begin to brake"},
    {10018059, Start::far_away, "the same"},
    {40450827, Start::as_drawn, "reckoned to be there as a sample is lost, driven on, and later than said"},
    {20140503, Start::far_away, "taken for arrived by what its force still owed, further away than kicks are for"},
    {20159589, Start::far_away, "passes its target as a sample is lost in which it was to brake"},
    {600024, Start::far_away, "ends its approach further away than kicks are for"},
    {600285, Start::far_away, "ends its approach further away than kicks are for"},
    {601090, Start::far_away, "ends its approach further away than kicks are for"},
    {78, Start::slow, "stands again and again between bounds that hardly differ, taken for driven to and fro"},
    {458, Start::slow, "the same with jitter"},
    {497, Start::slow, "the same with noise: what it was allowed is a fiftieth of what its brake takes over at"},
    {624, Start::slow, "a count a period is a third of its speed"},
    {30200012, Start::slow, "turns again and again, as noise alone said on which side friction acts"},
    {403552, Start::far_away_in_pattern, "goes a quarter further beyond than said: every other sample is late"},
    {201499, Start::far_away_in_pattern, "a fifth further: it trusts readings little, and forces act late and early"},
    {5134012, Start::slow, "stands where a sample is lost, which 100,000 periods of approach do three times"},
};

TEST(BrakedCampaign, AxesThatFailedOnceKeepTheirPromise) {
  for (const CounterExample& example : counter_examples) {
    SCOPED_TRACE(example.what_was_wrong);
    auto axis = axis_of(example.number, example.from);
    ASSERT_TRUE(axis) << "axis " << example.number << " is refused";
    Tally tally;
    run(*axis, example.from, tally);
  }
}

double spread(const design::Interval& i) { return (i.most - i.least) / (i.most + i.least); }
double unknown(const BrakedClass& c) { return spread(c.mass_kg) + spread(c.force_gain); }

// A random move that the class can keep to; nothing where it can keep to none.
std::optional<design::BrakedDesign<float>> random_move(BrakedClass& c, Random& r) {
  c.jitter_s = 0;  // with which no move is certified
  const double least_m_s2 = design::least_acceleration_m_s2(c);
  c.move = design::MoveRequest{1, 1, least_m_s2 * r.decades(1, 30), {}};
  if (c.lag_s.most <= design::most_lag_with_jerk * c.period_s && unknown(c) <= design::most_unknown_with_jerk &&
      r.share() < 0.7) {
    const design::Interval jerk = design::jerk_m_s3(c);
    if (jerk.least < jerk.most) c.move->jerk_m_s3 = r.decades(jerk.least, jerk.most);
  }
  const auto first = design::design_braked_kicks<float>(c);
  if (!first.possible()) return {};
  c.move->speed_m_s = design::least_move_speed_m_s(first) * r.decades(1, 25);
  c.move->distance_m = design::hand_over_m(first) * r.decades(2, 3000);
  auto design = design::design_braked_kicks<float>(c);
  const int kicks = design::most_kicks(c, design, design::kicks_begin_m(design), design.least_tolerance_m);
  if (kicks == 0 || kicks > law::KickJudge<float>::most_kicks || !design::keeps_speed(c, design)) return {};
  if (!report_of(c, design.least_tolerance_m).certified) return {};
  return design;
}

struct MoveTally {
  long moves = 0, runs = 0;
  double furthest = 0, fastest = 0, hardest = 0, latest = 0;
};

// What else happens to the runs of a move. A target that moves does it while the move is under way.
enum class Trouble { none, lost_samples, target_moves };

testing::Retarget retarget_of(const BrakedClass& c, const design::BrakedDesign<float>& design, Random& r) {
  const double near_m = design::hand_over_m(design) * r.decades(0.1, 10), far_m = 2 * c.move->distance_m * r.share();
  const double shift_m = (r.share() < 0.5 ? near_m : far_m) * (r.share() < 0.5 ? 1 : -1);
  return {.at_s = 0.7 * design::least_move_s(*c.move) * r.share(), .shift_m = shift_m};
}

// Where its target turns it back, force and friction brake an axis together for the moment in which it is taken for one
// that stands, and its readings do not tell.
double most_acceleration_m_s2(const BrakedClass& c, Trouble trouble) {
  const double both_m_s2 = (c.friction.lower_N + c.friction.upper_N) / c.mass_kg.least;
  return 1.001 * c.move->acceleration_m_s2 + (trouble == Trouble::target_moves ? both_m_s2 : 0);
}

void run_move(long number, const BrakedClass& c, const design::BrakedDesign<float>& design, Random& r, Trouble trouble,
              MoveTally& tally) {
  auto p = parameters(c, design.least_tolerance_m);
  p.max_approach_speed_m_s = 1e6F;
  const law::K3Table<float> unused;
  for (int kind = 0; kind < kinds; ++kind) {
    const testing::TrueAxis truth = true_axis(c, r);
    const Friction friction =
        friction_of_kind(kind, c, static_cast<std::uint64_t>(number * kinds + kind),
                         std::max(3 * design.floor_m, c.encoder_resolution_m), design.least_tolerance_m);
    const double start_m = r.share() < 0.5 ? c.move->distance_m : -c.move->distance_m;
    const double longest_s =
        150 * c.period_s * (2 * design.kicks.either_way_periods + 1500) + 20 + 20 * design::least_move_s(*c.move);
    const double encoder_offset = r.between(-0.5, 0.5);
    const bool target_moves = trouble == Trouble::target_moves;
    const auto retarget = target_moves ? retarget_of(c, design, r) : testing::Retarget{};
    const auto end = testing::run_kicked_axis<float>(
        p, unused, design.kicks, truth, friction, start_m, 0, longest_s, 2, 50, encoder_offset, retarget,
        trouble == Trouble::lost_samples ? disturbance(c, r) : testing::Disturbance{});
    ++tally.runs;
    tally.fastest = std::max(tally.fastest, end.approach_m_s / c.move->speed_m_s);
    tally.hardest = std::max(tally.hardest, end.approach_m_s2 / c.move->acceleration_m_s2);
    const std::string where = "move " + std::to_string(number) + ", friction " + std::to_string(kind);
    EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault);
    EXPECT_LE(end.approach_m_s, 1.01 * c.move->speed_m_s) << where;
    EXPECT_LE(end.approach_m_s2, most_acceleration_m_s2(c, trouble)) << where;
    if (target_moves) continue;  // the others are promised from rest
    const double approach_beyond_m = design::approach_beyond_m(c, design, c.move->speed_m_s);
    tally.furthest = std::max(tally.furthest, end.approach_beyond_m / approach_beyond_m);
    EXPECT_LE(end.approach_beyond_m, approach_beyond_m) << where;
    const double approach_s = design::approach_s(c, design, 1e6, c.move->distance_m);
    tally.latest = std::max(tally.latest, (end.kicks > 0 ? end.first_kick_s : end.time_s) / approach_s);
    EXPECT_LE(end.kicks > 0 ? end.first_kick_s : end.time_s, approach_s) << where;
    EXPECT_LE(end.first_kick_m, design::kicks_begin_m(design) + c.encoder_resolution_m) << where;
  }
}

// The move of a number, where it is certified.
void run_numbered_move(long number, Trouble trouble, MoveTally& tally) {
  Random r{static_cast<std::uint64_t>(number) + 5'000'000};
  BrakedClass c = random_axes(r);
  const auto design = random_move(c, r);
  if (!design) return;
  ++tally.moves;
  run_move(number, c, *design, r, trouble, tally);
}

void run_moves(Trouble trouble) {
  const long moves = asked_for("BREAKAWAY_BRAKED_MOVES", 100);
  MoveTally tally;
  const long first = asked_for("BREAKAWAY_FIRST_AXIS", 0);
  for (long number = first; number < first + moves; ++number) run_numbered_move(number, trouble, tally);
  std::printf(
      "%ld of %ld moves, %ld runs, at most %.3f of the speed, %.3f of the acceleration, %.2f of what may be beyond, "
      "%.3f of the time of the approach\n",
      tally.moves, moves, tally.runs, tally.fastest, tally.hardest, tally.furthest, tally.latest);
  EXPECT_GE(tally.moves, moves / 2);
}

TEST(BrakedCampaign, EveryCertifiedMoveKeepsItsLimits) { run_moves(Trouble::none); }

// One in a hundred of half of the runs, and noise.
TEST(BrakedCampaign, EveryCertifiedMoveThatLosesSamplesKeepsItsLimits) { run_moves(Trouble::lost_samples); }

TEST(BrakedCampaign, EveryCertifiedMoveWhoseTargetMovesKeepsItsLimits) { run_moves(Trouble::target_moves); }

TEST(BrakedCampaign, EveryRunOfAnAxisToldWrongEndsInHoldOrInAName) {
  const long first = asked_for("BREAKAWAY_FIRST_AXIS", 0), axes = asked_for("BREAKAWAY_TOLD_WRONG", 100);
  std::map<std::string_view, long> ends;
  constexpr int most_kicks = law::KickJudge<float>::most_kicks;
  long kicks = 0;
  const law::K3Table<float> unused;
  for (long number = first; number < first + axes; ++number) {
    Random r{static_cast<std::uint64_t>(number) + 1'000'000};
    const BrakedClass c = random_axes(r);
    const auto design = design::design_braked_kicks<float>(c);
    if (!design.possible()) continue;
    const double tolerance_m = design.least_tolerance_m * r.between(1, 3);
    const Wrong truth{c, r};
    BrakedClass true_class = c;
    true_class.friction = truth.friction;
    const double start_m = std::min(design.floor_m * std::pow(10, 4 * r.share()), 1.0) * (r.share() < 0.5 ? 1 : -1);
    const int kind = static_cast<int>(kinds * r.share());
    const Friction friction = friction_of_kind(kind, true_class, static_cast<std::uint64_t>(number),
                                               std::max(3 * design.floor_m, c.encoder_resolution_m), tolerance_m);
    const double longest_s = 300 * c.period_s * (2 * design.kicks.patient_periods + 1500) + 100;
    const auto end = testing::run_kicked_axis<float>(parameters(c, tolerance_m), unused, design.kicks, truth.axis,
                                                     friction, start_m, 0, longest_s, 4, 50, r.between(-0.5, 0.5));
    ++ends[end.held ? "held" : end.no_motion ? "no motion under force" : to_string(end.fault)];
    kicks = std::max<long>(kicks, end.kicks);
    EXPECT_TRUE(end.held || end.ends_by_name())
        << "run " << number << ", friction " << kind << ": error " << end.error_m << " after " << end.kicks << " kicks";
    EXPECT_LE(end.kicks, most_kicks) << "run " << number << ", friction " << kind << ": " << to_string(end.fault);
  }
  for (const auto& [name, count] : ends) std::printf("%s: %ld\n", name.data(), count);
  std::printf("at most %ld kicks\n", kicks);
}

// What failed before the certificate knew better, and is certified still.
TEST(BrakedCampaign, MovesThatFailedOnceKeepTheirLimits) {
  struct Example {
    long number;
    const char* what;
  };
  MoveTally tally;
  for (const Example& example : {
           Example{2078, "stuck again and again for 110 s before its end, and was not left to the kicks"},
           {3549, "went a fifth further beyond its target than was said: a jerk of five periods"},
           {11546, "a thousandth further, under one friction"},
           {21237, "a fifth further, a force gain off by a tenth"},
           {30256, "was driven to and fro where the brake did not take over from a plan that braked harder"},
           {702310, "reached its speed within seven periods of jerk, and went 2 % faster"},
           {7001124, "half as far again: friction fell, and the jerk let it be answered in ten periods"},
       }) {
    const long before = tally.moves;
    run_numbered_move(example.number, Trouble::none, tally);
    EXPECT_EQ(tally.moves, before + 1) << "move " << example.number << " is refused, which " << example.what;
  }
}

}  // namespace
}  // namespace breakaway::campaign
