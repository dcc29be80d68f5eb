// The loop on plants beyond the rigid axis: the force stays bounded, the run ends by name, and what the law cannot
// settle is stated as it is.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/axis_mechanism.hpp"
#include "breakaway/sil/margins.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"
#include "breakaway/study/friction_study.hpp"

namespace breakaway::closed_loop {
namespace {

scenario::Scenario scene(const std::string& name) {
  return scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/" + name + ".toml");
}

class PlantScene : public ::testing::TestWithParam<const char*> {};

TEST_P(PlantScene, SettlesWithinItsToleranceUnderBoundedForce) {
  const auto s = scene(GetParam());
  const auto result = sil::run_loop_scenario(s, {});
  const auto& axis = result.axes[0];
  EXPECT_TRUE(axis.settled);
  EXPECT_TRUE(axis.faults.empty());
  EXPECT_LE(std::abs(axis.final_error_m), judged_tolerance_m(s.node, s.node.axes[0]));
  EXPECT_LE(axis.max_force_N, sil::most_true_N(s.node.axes[0]) * (1 + 1e-12));
  EXPECT_EQ(result.loop->missed_ticks, 0U);
  EXPECT_EQ(axis.load_position_m.has_value(), s.worlds[0].plant.load.has_value());
  EXPECT_EQ(axis.told, config::told_otherwise(s.node.axes[0]));
}

INSTANTIATE_TEST_SUITE_P(Table, PlantScene,
                         ::testing::Values("vertical_axis", "presliding_axis", "fine_axis", "belt_axis", "worn_axis"),
                         [](const auto& file) { return std::string{file.param}; });

// A drive that makes more force than its node is told, or less, gives at the limit what is true of it.
TEST(Told, AForceGainPassesNoLimitOfTheForce) {
  for (const double gain : {0.8, 1.25}) {
    auto s = scene("braked_axis");
    config::Axis& axis = s.node.axes[0];
    axis.truth = config::truth_of(axis);
    axis.drive->force_per_torque_N_per_Nm *= gain;
    const auto result = sil::run_loop_scenario(s, {}).axes[0];
    EXPECT_NEAR(result.max_force_N, config::max_force_N(axis) / gain, 1e-2 * result.max_force_N) << "it is used up";
    const auto margins = sil::margins(axis, *result.excursions, result.max_force_N);
    ASSERT_STREQ(margins.back().name, "force_N");
    EXPECT_NEAR(margins.back().left, 0, 1e-2 * result.max_force_N) << gain;
    EXPECT_GE(margins.back().left, -1e-9) << gain;
  }
}

// What the same belt does when the carriage is read: it is the carriage that rests on the target, and the motor that
// friction and spring leave off it.
TEST(Belt, ReadAtTheCarriageRestsWithItOnTheTargetAndNeverBeyond) {
  std::ifstream file{std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/belt_axis.toml"};
  std::ostringstream whole;
  whole << file.rdbuf();
  std::string text = whole.str();
  for (const auto& [was, is] : {std::pair{"encoder = \"motor\"", "encoder = \"load\""},
                                {"position_tolerance_m = 3.2e-4", "position_tolerance_m = 6.5e-4"},
                                {"settle_tolerance_m = 3.21e-4", "settle_tolerance_m = 6.51e-4"}}) {
    const auto at = text.find(was);
    ASSERT_NE(at, std::string::npos) << was;
    text.replace(at, std::string{was}.size(), is);
  }
  const auto s = scenario::parse_scenario(text, "belt_axis.toml");
  const auto axis = sil::run_loop_scenario(s, {}).axes[0];
  EXPECT_TRUE(axis.settled);
  EXPECT_TRUE(axis.faults.empty());
  EXPECT_NEAR(*axis.load_position_m, 0, 6.5e-4 + 0.5e-6);
  EXPECT_LE(axis.excursions->beyond_m, 0.5e-6);
  EXPECT_GT(axis.kicks.size(), 0U);
}

// Its weight is four fifths of the least friction, so that it stays where it is while the drive is set up.
TEST(Weight, IsCarriedByTheFeedforwardUnderTheBrakeWithinTheCertifiedError) {
  auto s = scene("braked_axis");
  s.worlds[0].plant.force_N = -2;
  s.node.axes[0].controller.impulsive->feedforward_N = 2;
  s.node.axes[0].uncertainty.force_N = 0.05;
  s.node.axes[0].controller.position_tolerance_m = 3e-6;
  for (const double gain : {0.98, 1.0, 1.02}) {
    config::Truth truth = config::truth_of(s.node.axes[0]);
    truth.force_per_torque_N_per_Nm = gain * s.node.axes[0].drive->force_per_torque_N_per_Nm;
    s.node.axes[0].truth = truth;
    const auto result = sil::run_loop_scenario(s, {});
    const auto& axis = result.axes[0];
    EXPECT_TRUE(axis.settled) << gain;
    EXPECT_TRUE(axis.faults.empty()) << gain;
    EXPECT_LE(std::abs(axis.final_error_m), 3e-6 + 0.5e-6) << gain;
    EXPECT_LE(axis.excursions->beyond_m, 0.5e-6) << gain;
    EXPECT_LE(axis.max_force_N, 50) << gain;
  }
  s.worlds[0].plant.force_N = 2;  // towards the target, and nothing is given against it
  s.node.axes[0].controller.impulsive->feedforward_N = 0;
  s.node.axes[0].uncertainty.force_N = 0;
  EXPECT_FALSE(sil::run_loop_scenario(s, {}).axes[0].settled) << "then the feedforward does nothing";
}

// The brake opens with the first command, and gravity acts alone until the drive carries the weight.
TEST(Weight, SagsNoFurtherThanTheCertificateSaysAndIsBroughtBack) {
  auto s = scene("braked_axis");
  config::Axis& axis = s.node.axes[0];
  axis.uncertainty.force_N = 0.05;
  axis.uncertainty.force_gain = 0;
  axis.controller.position_tolerance_m = 1e-3;
  s.node.settle_tolerance_m = 1.01e-3;
  s.worlds[0].position_m = s.worlds[0].velocity_m_s = 0;
  for (const double weight_N : {4.0, 9.8, 30.0}) {
    for (const double lag_s : {1e-4, 1e-3, 4e-3}) {
      SCOPED_TRACE(weight_N);
      SCOPED_TRACE(lag_s);
      s.worlds[0].plant.force_N = axis.surroundings.force_N = -weight_N;
      axis.controller.impulsive->feedforward_N = weight_N;
      axis.drive->current_loop_time_constant_s = s.worlds[0].drive->current_loop_time_constant_s = lag_s;
      const double most_m = config::axis_design(s.node, axis).sag_m;
      ASSERT_TRUE(config::examine(s.node)[0].certified) << config::examine(s.node)[0].reasons.front();
      for (const double level : {0.0, 1.0}) {
        s.worlds[0].friction = {axis.friction.bounds, model::shape::constant(level)};
        const auto result = sil::run_loop_scenario(s, {}).axes[0];
        EXPECT_TRUE(result.settled);
        EXPECT_GE(result.excursions->lowest_m, -most_m);
      }
      EXPECT_GT(most_m, 0);
    }
  }
}

// Certified axes that were stopped as if something held them: one at a force that its weak drive leaves below friction,
// one while its spring was wound.
TEST(CounterExample, OfNoMotionUnderForceSettles) {
  for (const char* name : {"weaker_drive", "slow_spring"}) {
    SCOPED_TRACE(name);
    const auto s = scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR} + "/tests/closed_loop/counter_examples/" +
                                           name + ".toml");
    const auto axis = sil::run_loop_scenario(s, {}).axes[0];
    EXPECT_TRUE(axis.settled);
    EXPECT_TRUE(axis.faults.empty());
  }
}

// Friction that falls while a strong drive brakes led its approach up to 15 % further beyond the target than certified.
TEST(CounterExample, OfAnApproachThatGoesTooFarStaysWithinWhatIsCertified) {
  const auto s = scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR} +
                                         "/tests/closed_loop/counter_examples/strong_drive.toml");
  const double most_m = config::examine(s.node)[0].braked->approach_beyond_m;
  for (const std::uint64_t seed : {2580U, 2302U, 274409U, 166U}) {
    study::StudyOptions options;
    options.starts = {{-0.001, 0}};
    options.random_laws = 1;
    options.seed = seed;
    const auto rows = study::run_study(s, options);
    for (const auto& run : rows[0].runs) EXPECT_LE(run.excursions.overshoot_m, most_m) << seed;
  }
}

TEST(PlantScene, TheLoadIsWhereSpringAndPlayLeaveIt) {
  const auto result = sil::run_loop_scenario(scene("worn_axis"), {.trace = true});
  const auto& axis = result.axes[0];
  // Half the gap, and what its own friction bends the spring by.
  const double farthest_m = 10e-6 + 2 / 2e6;
  EXPECT_LE(std::abs(*axis.load_position_m), std::abs(axis.final_error_m) + farthest_m);
  EXPECT_GT(std::abs(*axis.load_position_m - axis.final_error_m), 1e-7) << "then nothing is worn";
  ASSERT_FALSE(axis.trace.empty());
  EXPECT_TRUE(axis.trace.back().load_position_m.has_value());
}

TEST(RigidAxis, RunsTheSameCodeAsWithoutTheseKeys) {
  auto plain = scene("can_axis");
  plain.run->duration_s = 1;
  const auto mechanism = sil::axis_mechanism(plain.node.axes[0], plain.worlds[0]);
  EXPECT_NE(dynamic_cast<const sil::BrakedSlide*>(mechanism.axis.get()), nullptr);
  EXPECT_EQ(mechanism.encoder, nullptr);
  auto told = plain;
  told.node.axes[0].truth = config::truth_of(plain.node.axes[0]);
  const auto first = sil::run_loop_scenario(plain, {.trace = true}),
             second = sil::run_loop_scenario(told, {.trace = true});
  ASSERT_EQ(first.axes[0].trace.size(), second.axes[0].trace.size());
  for (std::size_t i = 0; i < first.axes[0].trace.size(); ++i) {
    ASSERT_EQ(first.axes[0].trace[i].position_m, second.axes[0].trace[i].position_m) << i;
    ASSERT_EQ(first.axes[0].trace[i].force_N, second.axes[0].trace[i].force_N) << i;
  }
}

// The same axis as a [machine] of its motor and its load.
scenario::Scenario as_machine(scenario::Scenario s) {
  scenario::AxisWorld& world = s.worlds[0];
  const config::Truth truth = config::truth_of(s.node.axes[0]);
  const Eigen::Index n = world.plant.load ? 2 : 1;
  stability::LinearMachine<> machine;
  machine.mass = machine.directions = Eigen::MatrixXd::Identity(n, n);
  machine.mass(0, 0) = truth.mass_kg;
  machine.damping = machine.stiffness = Eigen::MatrixXd::Zero(n, n);
  machine.friction_N = Eigen::VectorXd::Constant(n, world.friction.bounds().upper_N);
  if (world.plant.load) {
    const model::FlexibleLoad& load = *world.plant.load;
    const Eigen::Matrix2d stretch{{1, -1}, {-1, 1}};
    machine.mass(1, 1) = load.mass_kg;
    machine.damping = load.coupling.damping_Ns_per_m * stretch;
    machine.stiffness = load.coupling.stiffness_N_per_m * stretch;
    machine.friction_N[1] = load.friction->bounds().upper_N;
  }
  const Eigen::VectorXd motor = Eigen::VectorXd::Unit(n, 0);
  s.machine = {machine, {0, Eigen::VectorXd::Constant(n, world.position_m), Eigen::VectorXd::Zero(n)}};
  world.place = {motor, motor};
  return s;
}

void expect_same_way(const sil::AxisResult& one, const sil::AxisResult& other, double apart_m) {
  EXPECT_EQ(one.settled, other.settled);
  EXPECT_EQ(one.kicks.size(), other.kicks.size());
  EXPECT_EQ(one.settling_time_s, other.settling_time_s);
  ASSERT_EQ(one.trace.size(), other.trace.size());
  for (std::size_t i = 0; i < one.trace.size(); ++i)
    ASSERT_NEAR(one.trace[i].position_m, other.trace[i].position_m, apart_m) << i;
}

TEST(MachineBehindTheBus, OfOneMassRunsAsTheRigidAxis) {
  auto rigid = scene("can_axis");
  rigid.worlds[0].friction = {rigid.worlds[0].friction.bounds(), model::shape::constant(1)};
  rigid.worlds[0].position_m = -0.1;
  rigid.worlds[0].velocity_m_s = 0;
  const auto one = sil::run_loop_scenario(rigid, {.trace = true}),
             other = sil::run_loop_scenario(as_machine(rigid), {.trace = true});
  expect_same_way(one.axes[0], other.axes[0], 1e-14);
  EXPECT_TRUE(other.axes[0].settled);
}

TEST(MachineBehindTheBus, OfMotorAndLoadRunsAsTheFlexibleAxis) {
  const auto belt = scene("belt_axis");
  const auto one = sil::run_loop_scenario(belt, {.trace = true}),
             other = sil::run_loop_scenario(as_machine(belt), {.trace = true});
  expect_same_way(one.axes[0], other.axes[0], 1e-9);
  ASSERT_TRUE(other.machine_end);
  EXPECT_NEAR(*one.axes[0].load_position_m, other.machine_end->q[1], 1e-9);
}

TEST(MachineBehindTheBus, SettlesAGantryWhoseEndsPushEachOther) {
  const auto s = scene("gantry");
  const auto result = sil::run_loop_scenario(s, {.trace = true});
  EXPECT_TRUE(result.settled());
  EXPECT_EQ(result.machine_trace.size(), result.axes[0].trace.size());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LE(std::abs(result.machine_end->q[static_cast<Eigen::Index>(i)]),
              judged_tolerance_m(s.node, s.node.axes[i]));
    EXPECT_GT(result.axes[i].kicks.size(), 0U);
  }
  auto alone = s;  // the same without what couples the ends
  alone.machine->machine.mass(0, 1) = alone.machine->machine.mass(1, 0) = 0;
  alone.machine->machine.stiffness.setZero();
  alone.machine->machine.damping.setZero();
  const auto apart = sil::run_loop_scenario(alone, {});
  EXPECT_GT(std::abs(apart.axes[0].final_error_m - result.axes[0].final_error_m), 1e-9) << "then nothing couples them";
}

// Gravity beside friction, as a slide and as a compliant axis whose compliance is too small to matter.
TEST(ConstantForce, IsTheSameForBothKindsOfPlant) {
  auto slide = scene("vertical_axis");
  slide.worlds[0].encoder_error.reset();
  slide.run->duration_s = 0.3;
  auto compliant = slide;
  compliant.worlds[0].plant.cogging = {1e-30, 1, 0};
  const auto first = sil::run_loop_scenario(slide, {.trace = true}).axes[0];
  const auto second = sil::run_loop_scenario(compliant, {.trace = true}).axes[0];
  ASSERT_EQ(first.trace.size(), second.trace.size());
  for (std::size_t i = 0; i < first.trace.size(); ++i)
    ASSERT_NEAR(first.trace[i].position_m, second.trace[i].position_m, 1e-10) << i;
}

TEST(Told, AMismatchIsStudiedUnderTheWholeClassOfFriction) {
  auto axis = scene("can_axis");
  axis.node.axes[0].truth = config::truth_of(axis.node.axes[0]);
  axis.node.axes[0].mass_kg = 1.05;
  study::StudyOptions options;
  options.starts = {{-0.05, 0}};
  options.random_laws = 5;
  const auto rows = study::run_study(axis, options);
  EXPECT_EQ(settled_runs(rows[0]), rows[0].runs.size()) << "the law bears 5 % more mass than there is";
  EXPECT_LE(largest_force_N(rows[0]), 50);
}

TEST(Told, TooMuchForceGainMakesLessForce) {
  auto axis = scene("can_axis");
  auto& described = axis.node.axes[0];
  described.truth = config::truth_of(described);
  described.drive->force_per_torque_N_per_Nm *= 2;
  axis.run->duration_s = 0.2;
  const auto result = sil::run_loop_scenario(axis, {});
  EXPECT_LE(result.axes[0].max_force_N, 25 * (1 + 1e-9)) << "it asks for 50 N at most, and gets half of that";
}

}  // namespace
}  // namespace breakaway::closed_loop
