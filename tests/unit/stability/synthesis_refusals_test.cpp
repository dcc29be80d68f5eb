// What synthesize() refuses before any search, what it says where none helps, and the ends of its searches.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "../../../controller/stability/src/gain_search.hpp"
#include "../refusal.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "two_mass_example.hpp"

namespace synthesis_refusals_test {
namespace {

using namespace breakaway::stability;
using breakaway::testing::refusal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double any = std::numeric_limits<double>::infinity();

// Figure 3 of [A]: a spring joins the two masses, and nothing else holds them.
ActuatedSystem floating_masses(const MatrixXd& actuators = MatrixXd::Identity(2, 2)) {
  LinearMachine<> machine = two_mass_example(0);
  machine.stiffness << 1, -1, -1, 1;
  return {machine, actuators};
}

struct BadWish {
  std::function<void(ActuatedSystem&, PdWants&)> spoil;
  const char* says;
};

TEST(SynthesisRefusals, SayWhatIsWrongWithTheWants) {
  const std::vector<BadWish> refused{
      {[](ActuatedSystem& s, PdWants&) { s.actuators = MatrixXd::Identity(3, 2); },
       "actuators must have a row for each coordinate and a column for each actuator"},
      {[](ActuatedSystem& s, PdWants&) { s.actuators = MatrixXd(2, 0); },
       "actuators must have a row for each coordinate and a column for each actuator"},
      {[](ActuatedSystem& s, PdWants&) { s.actuators.setZero(); }, "actuators are all 0: give each a direction"},
      {[](ActuatedSystem&, PdWants& w) { w.resting_error_m = 0; }, "the wanted resting error must be above 0 m"},
      {[](ActuatedSystem&, PdWants& w) { w.region_J = -1; }, "the wanted region must be 0 J or more"},
      {[](ActuatedSystem&, PdWants& w) { w.region_J = std::nan(""); }, "the wanted region must be 0 J or more"},
      {[](ActuatedSystem&, PdWants& w) { w.reach_m = -1; }, "the wanted reach must be 0 m or more"},
      {[](ActuatedSystem&, PdWants& w) { w.unit = VectorXd::Ones(3); }, "the units of the wants must be above 0"},
      {[](ActuatedSystem&, PdWants& w) {
         w.unit = Eigen::Vector2d{1, 0};
       },
       "the units of the wants must be above 0"},
      {[](ActuatedSystem&, PdWants& w) {
         w.unit = Eigen::Vector2d{1, any};
       },
       "the units of the wants must be above 0"},
      {[](ActuatedSystem&, PdWants& w) { w.resting_error_m = any; }, "say how far from the target it may rest"},
      {[](ActuatedSystem& s, PdWants&) { s.machine.friction_N.setZero(); },
       "the machine has no friction, so there is no resting error to design for"},
  };
  for (const BadWish& bad : refused) {
    ActuatedSystem system = floating_masses();
    PdWants wants{.resting_error_m = 1, .region_J = 1};
    bad.spoil(system, wants);
    const std::string message = refusal([&] { synthesize(system, wants, GainStructure::identical); });
    EXPECT_NE(message.find(bad.says), std::string::npos) << bad.says << ": " << message;
  }
}

// The actuator of the second mass leaves the first one on its spring of 1 N/m, with 1 N of friction.
TEST(SynthesisRefusals, OfIdenticalGainsNameTheBestRestingError) {
  const std::string message = refusal([] {
    synthesize(floating_masses(Eigen::Vector2d{0, 1}), {.resting_error_m = 0.5}, GainStructure::identical);
  });
  EXPECT_NE(message.find("a resting error of 0.5 m is out of reach of identical gains: the best is about 1"),
            std::string::npos)
      << message;
}

// The damper of the first mass stays at -0.375 N s/m whatever the second one does.
TEST(SynthesisRefusals, OfIdenticalGainsNameTheBestRegion) {
  const ActuatedSystem system{two_mass_example(0), Eigen::Vector2d{0, 1}};
  const std::string message = refusal([&] { synthesize(system, {.region_J = any}, GainStructure::identical); });
  EXPECT_NE(message.find("the region is out of reach of identical gains: the best is about "), std::string::npos)
      << message;
  EXPECT_EQ(message.find("about inf"), std::string::npos) << message;
}

TEST(SynthesisRefusals, OfIdenticalGainsNameNoRestingErrorWithoutEnd) {
  const std::string message =
      refusal([] { synthesize(floating_masses(), {.resting_error_m = 1e-300}, GainStructure::identical); });
  EXPECT_EQ(message.find("about inf"), std::string::npos) << message;
  EXPECT_NE(message.find("ask for less"), std::string::npos) << message;
}

TEST(SynthesisRefusals, OfFullGainsSayWhatToChangeWhereNothingCanBeSolved) {
  for (const PdWants& wants :
       {PdWants{.resting_error_m = 1e-300}, PdWants{.resting_error_m = 1e-300, .region_J = 10}}) {
    const std::string message = refusal([&] { synthesize(floating_masses(), wants, GainStructure::full); });
    EXPECT_TRUE(message.find("ask for") != std::string::npos || message.find("install") != std::string::npos)
        << message;
  }
}

TEST(SynthesisRefusals, OfFullGainsNameTheDirectionThatFrictionAloneCannotHold) {
  LinearMachine<> machine = two_mass_example(0);
  machine.directions = Eigen::Vector2d{1, 0};
  machine.friction_N = VectorXd::Ones(1);
  const std::string message = refusal([&] {
    synthesize({machine, Eigen::Vector2d{1, 0}}, {.region_J = 1}, GainStructure::full);
  });
  EXPECT_NE(message.find("the region is out of reach: the direction (0, 1) has the damping -0.375"), std::string::npos)
      << message;
}

TEST(SynthesisRefusals, OfFullGainsNameAProgramThatIsTooLarge) {
  ActuatedSystem system = floating_masses();
  system.machine.damping.setIdentity();
  system.machine.directions = MatrixXd::Ones(2, 1600);
  system.machine.friction_N = VectorXd::Ones(1600);
  const std::string message = refusal([&] { synthesize(system, {.resting_error_m = 1}, GainStructure::full); });
  EXPECT_NE(message.find("need a program of 3205 variables, which is too many"), std::string::npos) << message;
}

TEST(RestingError, IsWithoutEndWhereSpringsHoldNothing) {
  LinearMachine<> machine = two_mass_example();
  const VectorXd limit_m = VectorXd::Ones(2);
  EXPECT_NEAR(resting_error(machine, limit_m), 1, 1e-14);
  machine.stiffness(0, 1) = -0.5;
  EXPECT_EQ(resting_error(machine, limit_m), any) << "a skew part";
  machine.stiffness << 1, 1 - 1e-15, 1 - 1e-15, 1;
  EXPECT_EQ(resting_error(machine, limit_m), any) << "singular to rounding";
}

// Springs that hold one direction a million million times weaker than another: what Cholesky's method says of the rests
// and what is exact differ by more than is granted.
TEST(SynthesisRefusals, SayWhereRoundingIsTooCoarse) {
  int refused = 0;
  for (int i = 1; i <= 40; ++i) {
    LinearMachine<> machine = two_mass_example(1);
    const double coupling = std::sqrt(1.7 * 2.9) * (1 - 1e-12 * i);
    machine.stiffness << 1.7, coupling, coupling, 2.9;
    const double wanted_m = resting_error(machine, VectorXd::Ones(2));
    PdDesign design;
    const std::string message = refusal([&] {
      design = synthesize({machine, MatrixXd::Identity(2, 2)}, {.resting_error_m = wanted_m}, GainStructure::identical);
    });
    if (message.empty()) {
      EXPECT_LE(design.extent_m.maxCoeff(), wanted_m * (1 + 1e-9)) << i;
    } else {
      ++refused;
      EXPECT_EQ(message,
                "the gains found do not pass the certificate: rounding is too coarse for what is wanted; ask for a "
                "little less");
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(SynthesisLimits, AReachWithoutEndIsAttractionFromEverywhere) {
  const PdWants wants{.resting_error_m = 1, .reach_m = any};
  const PdDesign design = synthesize(floating_masses(), wants, GainStructure::identical);
  EXPECT_TRUE(std::isinf(design.reach_m));
  EXPECT_TRUE(design.attractivity.global());
  EXPECT_NEAR(design.gains.velocity_Ns_per_m(0, 0), 0.75 * (1 + 1e-3), 1e-4);
}

double least_damping_Ns_per_m(const ActuatedSystem& system, const PdWants& wants) {
  const PdDesign design = synthesize(system, wants, GainStructure::identical);
  return Eigen::SelfAdjointEigenSolver<MatrixXd>{design.closed_loop.damping}.eigenvalues()[0];
}

// Friction holds the masses together only where they move together. Damping of 1e-18 N s/m made the region infinite,
// and the way to rest took 1e18 s. A thousandth of sqrt(|M| |K|) is the size of a C that is none.
TEST(SynthesisLimits, WhatOnlyDampingHoldsIsDampedWithAMarginWhateverIsWanted) {
  LinearMachine<> machine = two_mass_example();
  machine.damping.setZero();
  machine.directions = Eigen::Vector2d{1, 1};
  machine.friction_N = VectorXd::Ones(1);
  const double asked = 0.99e-6 * std::sqrt(std::sqrt(2 * 10.0));
  for (const PdWants& wants : {PdWants{.resting_error_m = 5, .region_J = 10}, PdWants{.resting_error_m = 5},
                               PdWants{.reach_m = 3}, PdWants{.region_J = any}}) {
    for (const double own : {0.0, 1e-18}) {
      machine.damping = own * MatrixXd::Identity(2, 2);
      EXPECT_GE(least_damping_Ns_per_m({machine, MatrixXd::Identity(2, 2)}, wants), (1 - 1e-6) * asked) << own;
    }
  }
}

TEST(SynthesisLimits, AMarginOfDampingIsAskedForBesideAFiniteRegion) {
  LinearMachine<> machine = two_mass_example();
  machine.damping = Eigen::Vector2d{-0.375, 0}.asDiagonal();
  machine.directions = Eigen::Vector2d{1, 0};
  machine.friction_N = VectorXd::Ones(1);
  machine.stiffness = 2 * MatrixXd::Identity(2, 2);
  const PdDesign design = synthesize({machine, MatrixXd::Identity(2, 2)}, {.region_J = 0.5}, GainStructure::identical);
  EXPECT_TRUE(std::isfinite(design.attractivity.rho_star_J));
  EXPECT_GT(design.closed_loop.damping(1, 1), 0.9e-3 * 0.375);
}

// No gain reaches the second mass. Its damper is weak beside the first one's and its own.
TEST(SynthesisLimits, NoMoreDampingIsAskedForThanWhereNoActuatorActs) {
  LinearMachine<> machine = two_mass_example();
  machine.damping = Eigen::Vector2d{-0.375, 1e-4}.asDiagonal();
  machine.directions = Eigen::Vector2d{1, 0};
  machine.friction_N = VectorXd::Ones(1);
  machine.stiffness = 2 * MatrixXd::Identity(2, 2);
  for (const PdWants& wants : {PdWants{.region_J = 9}, PdWants{.region_J = any}})
    EXPECT_GT(least_damping_Ns_per_m({machine, Eigen::Vector2d{1, 0}}, wants), -0.375);
}

TEST(SynthesisLimits, ProgressGoesFromNothingToAllAndNeverBack) {
  std::vector<double> shares;
  synthesize(floating_masses(), {.resting_error_m = 1, .region_J = 16}, GainStructure::identical,
             [&](double share) { shares.push_back(share); });
  ASSERT_FALSE(shares.empty());
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GE(shares.front(), 0);
  EXPECT_GT(shares.back(), 0.8);
  EXPECT_LE(shares.back(), 1);
}

TEST(LeastAccepted, IsNoNumberWhereNothingIsAccepted) {
  const DesignProgress silent;
  int asked = 0;
  EXPECT_TRUE(std::isnan(least_accepted(1,
                                        [&](double) {
                                          ++asked;
                                          return false;
                                        },
                                        {silent, 0, 1})));
  EXPECT_EQ(asked, 25);
  EXPECT_NEAR(least_accepted(1, [](double x) { return x >= 70; }, {silent, 0, 1}), 70, 1e-7);
}

// With a spring of 0.1 N/m to the ground E reaches to V = 10 J, far out of { V < rho* = 1.8 J }; with friction on one
// mass nothing is certified at all.
TEST(GainSweep, SaysWhereEIsNotCertified) {
  const MatrixXd gain = MatrixXd::Identity(2, 2);
  const std::vector<GainSweepRow> soft = sweep_velocity_gain(floating_masses(), {0.1 * gain, gain}, {0.001, 0.9});
  EXPECT_GT(soft.at(0).rho_star_J, 0);
  EXPECT_FALSE(soft.at(0).E_certified);
  EXPECT_TRUE(soft.at(1).E_certified);
  ActuatedSystem one_friction = floating_masses();
  one_friction.machine.friction_N[0] = 0;
  const std::vector<GainSweepRow> none = sweep_velocity_gain(one_friction, {gain, gain}, {0.5});
  EXPECT_EQ(none.at(0).rho_star_J, 0);
  EXPECT_FALSE(none.at(0).E_certified);
}

// Its unstable motion is one that the actuator does not reach. A gain of 4.5e15 rounded it away.
TEST(SynthesisRefusals, NoIdenticalGainIsGreatEnoughForWhatTheActuatorDoesNotReach) {
  LinearMachine<> machine = two_mass_example();
  for (const PdWants& wants : {PdWants{.region_J = any}, PdWants{.region_J = 17}, PdWants{.reach_m = 100}}) {
    const std::string said = refusal([&] {
      synthesize({machine, MatrixXd{Eigen::Vector2d{1, 1}}}, wants, GainStructure::identical);
    });
    EXPECT_NE(said.find("out of reach of identical gains"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace synthesis_refusals_test
