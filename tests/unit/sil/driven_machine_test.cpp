// A machine under the forces of drives against what moves by other equations: the closed forms of a rigid axis, the
// integration of a flexible one, and the balances of momentum and energy.
#include "breakaway/sil/driven_machine.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/compliant_axis.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/machine_axis.hpp"

namespace breakaway::sil {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using scenario::CoupledMachine;

constexpr double period_s = 1e-3, lag_s = 1e-4;

CoupledMachine machine_of(const MatrixXd& mass, const MatrixXd& damping, const MatrixXd& stiffness,
                          const MatrixXd& directions, const VectorXd& friction_N) {
  const Eigen::Index n = mass.rows();
  return {{mass, damping, stiffness, directions, friction_N}, {0, VectorXd::Zero(n), VectorXd::Zero(n)}};
}

CoupledMachine one_mass(double mass_kg, double friction_N) {
  const auto one = [](double value) { return MatrixXd::Constant(1, 1, value); };
  return machine_of(one(mass_kg), one(0), one(0), one(1), VectorXd::Constant(1, friction_N));
}

// Motor and load on a spring with damping, both on friction.
CoupledMachine flexible_axis() {
  const MatrixXd stretch = (MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  return machine_of(Eigen::Vector2d{0.4, 0.6}.asDiagonal(), 40 * stretch, 2e5 * stretch, MatrixXd::Identity(2, 2),
                    Eigen::Vector2d{1.3, 1.2});
}

DrivenMachine::Axis axis_at(Eigen::Index coordinate, Eigen::Index coordinates, double lag = lag_s) {
  const VectorXd unit = VectorXd::Unit(coordinates, coordinate);
  return {{unit, unit}, lag};
}

void open_brakes(DrivenMachine& machine, std::size_t axes) {
  for (std::size_t i = 0; i < axes; ++i) machine.open_brake(0);
}

// One command a period, and the lag of the loop that follows it.
class Drive {
 public:
  explicit Drive(unsigned seed, double lag = lag_s) : random_{seed}, lag_s_{lag} {}

  const model::AppliedForce& command(double time_s) {
    const double present_N = force_.at_N(time_s, 0, 0);
    if (held_ == 0) {
      held_ = std::uniform_int_distribution<>{1, 40}(random_);
      force_N_ = std::uniform_real_distribution<>{-12, 12}(random_);
    }
    --held_;
    force_ = {.constant_N = force_N_,
              .transient_N = lag_s_ > 0 ? present_N - force_N_ : 0,
              .time_constant_s = lag_s_,
              .start_s = time_s};
    return force_;
  }

 private:
  std::mt19937 random_;
  double lag_s_;
  int held_ = 0;
  double force_N_ = 0;
  model::AppliedForce force_;
};

TEST(DrivenMachine, OfOneMassIsTheRigidAxis) {
  for (const double lag : {0.0, lag_s}) {
    DrivenMachine machine{one_mass(1.3, 3), {axis_at(0, 1, lag)}};
    open_brakes(machine, 1);
    motion::Slide slide{1.3, {{3, 3}, model::shape::constant(1)}, {}};
    Drive drive{7, lag};
    double farthest_m = 0;
    for (int tick = 0; tick < 2000; ++tick) {
      const auto force = drive.command(tick * period_s);
      machine.change_force(0, force);
      machine.advance_to((tick + 1) * period_s);
      slide.advance_to((tick + 1) * period_s, force);
      farthest_m = std::max(farthest_m, std::abs(slide.state().position_m));
      ASSERT_NEAR(machine.state_of(0).position_m, slide.state().position_m, 1e-13 * farthest_m) << lag << ' ' << tick;
      ASSERT_EQ(machine.state_of(0).sticking, slide.sticking()) << tick;
    }
    EXPECT_EQ(machine.state_of(0).slips, slide.counters().slips);
    EXPECT_GT(farthest_m, 1e-3);
  }
}

TEST(DrivenMachine, OfMotorAndLoadIsTheFlexibleAxis) {
  DrivenMachine machine{flexible_axis(), {axis_at(0, 2)}};
  open_brakes(machine, 1);
  const model::FlexibleLoad load{0.6, {2e5, 40, 0}, model::FrictionLaw{{1.2, 1.2}, model::shape::constant(1)}};
  motion::CompliantAxis axis{{.mass_kg = 0.4, .load = load}, {{1.3, 1.3}, model::shape::constant(1)}, {}};
  Drive drive{3};
  double farthest_m = 0;
  for (int tick = 0; tick < 600; ++tick) {
    const auto force = drive.command(tick * period_s);
    machine.change_force(0, force);
    machine.advance_to((tick + 1) * period_s);
    axis.advance_to((tick + 1) * period_s, force);
    const motion::CompliantState state = axis.state();
    farthest_m = std::max(farthest_m, std::abs(state.position_m));
    ASSERT_NEAR(machine.state().q[0], state.position_m, 1e-9 * farthest_m) << tick;
    ASSERT_NEAR(machine.state().q[1], state.load_position_m, 1e-9 * farthest_m) << tick;
    ASSERT_EQ(machine.state_of(0).sticking, axis.sticking()) << tick;
  }
  EXPECT_GT(farthest_m, 1e-3);
}

// Without friction and dampers to the ground the momentum is the impulse of the drives, whatever acts inside.
TEST(DrivenMachine, TakesTheMomentumThatItsDrivesGive) {
  auto coupled = flexible_axis();
  coupled.machine.directions = (MatrixXd(2, 1) << 1, -1).finished();  // rubs inside
  coupled.machine.friction_N = VectorXd::Constant(1, 2);
  DrivenMachine machine{coupled, {axis_at(0, 2), axis_at(1, 2)}};
  open_brakes(machine, 2);
  std::array drives{Drive{1}, Drive{2}};
  double impulse_Ns = 0, largest_Ns = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto force = drives[i].command(tick * period_s);
      machine.change_force(i, force);
      impulse_Ns += force.constant_N * period_s - force.transient_N * lag_s * std::expm1(-period_s / lag_s);
    }
    machine.advance_to((tick + 1) * period_s);
    largest_Ns = std::max(largest_Ns, std::abs(impulse_Ns));
    const double momentum_Ns = Eigen::Vector2d{0.4, 0.6}.dot(machine.state().v);
    ASSERT_NEAR(momentum_Ns, impulse_Ns, 1e-11 * largest_Ns) << tick;
  }
}

// What the drives give up is in the masses and springs, or was rubbed away: never more.
TEST(DrivenMachine, HasNoMoreEnergyThanItsDrivesGave) {
  const auto coupled = flexible_axis();
  DrivenMachine machine{coupled, {axis_at(0, 2, 0)}};
  open_brakes(machine, 1);
  Drive drive{5, 0};
  double work_J = 0, most_J = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    const auto force = drive.command(tick * period_s);
    const double before_m = machine.state().q[0];
    machine.change_force(0, force);
    machine.advance_to((tick + 1) * period_s);
    work_J += force.constant_N * (machine.state().q[0] - before_m);
    most_J = std::max(most_J, std::abs(work_J));
    ASSERT_LE(stability::energy_J(coupled.machine, machine.state()), work_J + 1e-12 * most_J) << tick;
  }
  EXPECT_GT(most_J, 0.01);
}

TEST(DrivenMachine, AxesThatNothingCouplesMoveAsIfAlone) {
  const VectorXd masses = Eigen::Vector2d{1, 3}, friction_N = Eigen::Vector2d{3, 4};
  DrivenMachine both{
      machine_of(masses.asDiagonal(), MatrixXd::Zero(2, 2), MatrixXd::Zero(2, 2), MatrixXd::Identity(2, 2), friction_N),
      {axis_at(0, 2), axis_at(1, 2)}};
  open_brakes(both, 2);
  std::vector<DrivenMachine> alone;
  for (int i = 0; i < 2; ++i) {
    alone.emplace_back(one_mass(masses[i], friction_N[i]), std::vector{axis_at(0, 1)});
    open_brakes(alone.back(), 1);
  }
  std::array drives{Drive{11}, Drive{12}};
  for (int tick = 0; tick < 1000; ++tick) {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto force = drives[i].command(tick * period_s);
      both.change_force(i, force);
      alone[i].change_force(0, force);
      alone[i].advance_to((tick + 1) * period_s);
    }
    both.advance_to((tick + 1) * period_s);
    for (std::size_t i = 0; i < 2; ++i) {
      const AxisState here = both.state_of(i), there = alone[i].state_of(0);
      ASSERT_NEAR(here.position_m, there.position_m, 1e-13 * (1 + std::abs(there.position_m))) << tick;
      ASSERT_EQ(here.sticking, there.sticking) << tick;
      ASSERT_EQ(here.slips, there.slips) << tick;
    }
  }
}

TEST(DrivenMachine, SticksOnlyWhereFrictionHoldsAllThatIsCoupled) {
  DrivenMachine machine{flexible_axis(), {axis_at(0, 2, 0)}};
  open_brakes(machine, 1);
  machine.change_force(0, {.constant_N = 1.2});
  machine.advance_to(0.01);
  EXPECT_TRUE(machine.state_of(0).sticking) << "the motor alone bears 1.3 N";
  EXPECT_TRUE(std::isnan(machine.friction_on_N(0)));
  machine.change_force(0, {.constant_N = 4, .start_s = 0.01});
  machine.advance_to(0.02);
  EXPECT_FALSE(machine.state_of(0).sticking);
  EXPECT_EQ(machine.friction_on_N(0), 1.3);
  EXPECT_EQ(machine.state_of(0).slips, 1U);
}

TEST(DrivenMachine, StandsUntilTheLastBrakeOpens) {
  auto coupled = flexible_axis();
  coupled.start.v = Eigen::Vector2d{1, 1};
  DrivenMachine machine{coupled, {axis_at(0, 2), axis_at(1, 2)}};
  machine.open_brake(0.5);
  machine.advance_to(1);
  EXPECT_EQ(machine.state().q, coupled.start.q);
  machine.open_brake(1.5);
  machine.advance_to(1.6);
  EXPECT_NEAR(machine.state().time_s, 0.1, 1e-15) << "since the last brake opened";
  EXPECT_GT(machine.state().q[0], 0.05);
}

TEST(DrivenMachine, RefusesByItsNameAMachineThatFliesApart) {
  CoupledMachine machine = one_mass(1, 1);
  machine.machine.stiffness(0, 0) = -1e8;
  machine.start.q[0] = 0.1;
  DrivenMachine driven{machine, {axis_at(0, 1)}};
  open_brakes(driven, 1);
  const std::string said = testing::refusal([&] {
    for (int period = 1; period < 1000; ++period) driven.advance_to(period * period_s);
  });
  EXPECT_NE(said.find("the [machine] flies apart"), std::string::npos) << said;
}

// A spring that vibrates a hundred times in a period costs each period little, and the run far too much. Behind the
// bus there is no other method to take.
TEST(DrivenMachine, HasOneBudgetForTheWholeRun) {
  CoupledMachine machine = one_mass(1, 1);
  machine.machine.stiffness(0, 0) = std::pow(2e5 * std::acos(-1.0), 2);
  machine.start.q[0] = 0.1;
  DrivenMachine driven{machine, {axis_at(0, 1)}};
  motion::WorkBudget budget{
      {.duration_s = 1, .may_end = false, .work = 1e5}, "the [machine]", "the cause", "the remedy"};
  driven.limit_work(&budget);
  open_brakes(driven, 1);
  int period = 1;
  const std::string said = testing::refusal([&] {
    for (; period <= 1000; ++period) driven.advance_to(period * period_s);
  });
  EXPECT_NE(said.find("following the [machine] for 1 s would take"), std::string::npos) << said;
  EXPECT_NE(said.find("the remedy"), std::string::npos) << said;
  EXPECT_GT(period, 5);
}

// What is refused in the first period counts as work, too.
TEST(DrivenMachine, NamesNoLessThanTheBudgetAsTheCostOfWhatExceedsIt) {
  CoupledMachine machine = one_mass(1, 1e-9);
  machine.machine.stiffness(0, 0) = std::pow(2e9 * std::acos(-1.0), 2);
  machine.start.q[0] = 0.1;
  DrivenMachine driven{machine, {axis_at(0, 1)}};
  motion::WorkBudget budget{{.duration_s = 1, .work = 1e5}, "the [machine]", "the cause", "the remedy"};
  driven.limit_work(&budget);
  open_brakes(driven, 1);
  const std::string said = testing::refusal([&] { driven.advance_to(1); });
  EXPECT_NE(said.find("would take more than 1e+05 evaluations"), std::string::npos) << said;
}

// Two drives of one machine are asked one after the other; the first must not move on under what the second did
// before.
TEST(MachineAxis, KnowsTheForceOfTheOtherDriveSinceItChanged) {
  const auto machine = std::make_shared<DrivenMachine>(one_mass(1, 3), std::vector{axis_at(0, 1, 0), axis_at(0, 1, 0)});
  MachineAxis one{machine, 0, Mounting::straight}, other{machine, 1, Mounting::inverted};
  for (MachineAxis* axis : {&one, &other}) axis->release(0);
  one.change_force({.constant_N = 5});
  other.change_force({.constant_N = -5});
  one.advance_to(0.1, {.constant_N = 5});
  EXPECT_NEAR(one.position_m(), 0.5 * 7 * 0.01, 1e-15) << "10 N less 3 N of friction on 1 kg";
  EXPECT_EQ(other.position_m(), -one.position_m());
}

}  // namespace
}  // namespace breakaway::sil
