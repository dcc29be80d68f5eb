#include "breakaway/stability/machine_certificate.hpp"

#include <gtest/gtest.h>

#include <string>

namespace breakaway::stability::machine_certificate_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Two motors on one beam, each end 3.67 kg and 1.33 kg of it thrown at the other, at 2 kHz.
CoupledAxes beam() {
  CoupledAxes a;
  a.mass = (MatrixXd(2, 2) << 3.6667, 1.3333, 1.3333, 3.6667).finished();
  a.mass_error = 0.02 * a.mass;
  a.stiffness = 40 * (MatrixXd(2, 2) << 1, -1, -1, 1).finished();
  a.damping = a.stiffness / 40;
  a.load_N = a.brake_N = VectorXd::Zero(2);
  a.friction_lower_N = VectorXd::Constant(2, 7);
  a.friction_upper_N = VectorXd::Constant(2, 13);
  a.force_step_N = VectorXd::Constant(2, 0.05);
  a.max_force_N = VectorXd::Constant(2, 100);
  a.period_s = 5e-4;
  a.lag_s = 1e-4;
  return a;
}

SampledApproach approach() {
  return {VectorXd::Constant(2, 1500), VectorXd::Constant(2, 80), VectorXd::Constant(2, 0.02),
          VectorXd::Constant(2, 1e-6), 1};
}

VectorXd tolerance() { return VectorXd::Constant(2, 5e-5); }

MachineCertificate certificate() { return certify_machine(beam(), approach(), tolerance()); }

bool fails_in(const MachineCertificate& c, const char* condition) {
  return !c.certified && c.reason.rfind(condition, 0) == 0;
}

TEST(MachineCertificate, CertifiesTheBeamAndItsBoxHoldsEveryRest) {
  const MachineCertificate c = certificate();
  ASSERT_TRUE(c.certified) << c.reason;
  for (const Condition& condition : c.conditions) EXPECT_TRUE(condition.holds) << condition.name;
  // By hand: K_cl = [[1540, -40], [-40, 1540]], so that friction alone holds an end up to 13 (1540 + 40)/(1540^2 -
  // 40^2).
  const double rest_m = 13.0 * 1580 / (1540.0 * 1540 - 1600);
  EXPECT_GT(c.axes[0].gate_m, rest_m);
  EXPECT_LT(c.axes[0].gate_m, 1.1 * rest_m);
  EXPECT_GT(c.axes[0].box_m, c.axes[0].gate_m);
  EXPECT_EQ(c.most_kicks, c.axes[0].most_kicks + c.axes[1].most_kicks);
  EXPECT_GT(c.axes[0].most_kicks, 0U);
}

TEST(MachineCertificate, TheKicksOfAnAxisKeepEveryConditionOfTheOther) {
  const MachineCertificate c = certificate();
  const VectorXd box_m = (VectorXd(2) << c.axes[0].box_m, c.axes[1].box_m).finished();
  EXPECT_TRUE(tightest(beam(), box_m, c.axes[0].kick_N, 0).holds());
  EXPECT_FALSE(tightest(beam(), box_m, 1.02 * c.axes[0].kick_N, 0).holds());
}

TEST(MachineCertificate, AShorterPeriodLosesLessToSampling) {
  CoupledAxes a = beam();
  const double lost_N = certificate().sampled.lost_N[0];
  a.period_s = 2.5e-4;
  a.lag_s = 5e-5;
  EXPECT_LT(certify_machine(a, approach(), tolerance()).sampled.lost_N[0], 0.75 * lost_N);
}

TEST(MachineCertificate, ALongPeriodIsRefusedForItsSampling) {
  CoupledAxes a = beam();
  a.period_s = 4e-3;
  const MachineCertificate c = certify_machine(a, approach(), tolerance());
  EXPECT_TRUE(fails_in(c, "sampling")) << c.reason;
}

TEST(MachineCertificate, AStiffSpringBetweenTheEndsIsRefusedAtTheRelease) {
  CoupledAxes a = beam();
  a.stiffness *= 10;
  const MachineCertificate c = certify_machine(a, approach(), tolerance());
  EXPECT_TRUE(fails_in(c, "release")) << c.reason;
}

TEST(MachineCertificate, MassesThatAreHardlyKnownAreRefusedWithTheirPair) {
  CoupledAxes a = beam();
  a.mass_error(0, 1) = a.mass_error(1, 0) = 1;
  SampledApproach from_near = approach();
  from_near.start_m.setConstant(2e-3);
  const MachineCertificate c = certify_machine(a, from_near, tolerance());
  EXPECT_TRUE(fails_in(c, "kicks of axis 1 alone")) << c.reason;
  EXPECT_NE(c.reason.find("axis 2 must hold"), std::string::npos) << c.reason;
}

TEST(MachineCertificate, AWeakDriveIsRefused) {
  CoupledAxes a = beam();
  a.max_force_N = VectorXd::Constant(2, 30);
  EXPECT_TRUE(fails_in(certify_machine(a, approach(), tolerance()), "force of the approach"));
}

TEST(MachineCertificate, AToleranceBelowTheFloorIsRefusedWithTheLeastOne) {
  const MachineCertificate c = certify_machine(beam(), approach(), VectorXd::Constant(2, 1e-6));
  EXPECT_TRUE(fails_in(c, "accuracy of axis 1")) << c.reason;
  const VectorXd least = VectorXd::Constant(2, c.axes[0].least_tolerance_m);
  EXPECT_TRUE(certify_machine(beam(), approach(), least).certified);
}

TEST(MachineCertificate, AnAxisThatNothingPullsBackIsRefused) {
  SampledApproach p = approach();
  p.position_gain_N_per_m[1] = 0;
  CoupledAxes a = beam();
  a.stiffness.setZero();
  EXPECT_TRUE(fails_in(certify_machine(a, p, tolerance()), "closed loop stiffness"));
}

TEST(MachineCertificate, MassesAreNotTrustedBeyondTheirRange) {
  CoupledAxes a = beam();
  a.range_m = VectorXd::Constant(2, 0.1);
  EXPECT_TRUE(certify_machine(a, approach(), tolerance()).certified);
  a.range_m[1] = 0.021;
  EXPECT_TRUE(fails_in(certify_machine(a, approach(), tolerance()), "range of the masses"));
}

TEST(MachineCertificate, ADistanceThatNeedsLittleForceOverManyPeriodsTakesOneLessWithAllThereIs) {
  const MachineCertificate c = certificate();
  const KickedAxis& k = c.axes[0].kicked;
  for (double aim_m = 2e-6; aim_m < 0.02; aim_m *= 1.01) {
    const KickPulse pulse = kick_pulse(k, 1.05 * k.sure_N, aim_m, 5e-4);
    EXPECT_GE(pulse.force_N, k.sure_N) << aim_m;
    EXPECT_LE(k.most_travel_m(pulse.force_N, pulse.periods * 5e-4), aim_m * (1 + 1e-9));
    EXPECT_GT(sure_travel_m(k, 1.05 * k.sure_N, aim_m, 5e-4), 0);
  }
}

}  // namespace
}  // namespace breakaway::stability::machine_certificate_test
