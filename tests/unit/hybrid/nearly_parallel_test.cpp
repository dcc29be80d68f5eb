// Directions that are parallel to rounding are one; those that are only nearly parallel are told apart.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"

namespace nearly_parallel_test {
namespace {

using breakaway::hybrid::Adaptive;
using breakaway::hybrid::Event;
using breakaway::hybrid::EventDriven;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::TimeStepping;
using State = MachineState<Eigen::Dynamic>;

// Two directions along x, one of them turned by `angle`.
LinearMachine<> two_masses(double angle) {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = (Eigen::Matrix2d{} << 0.125, 0.375, 0.375, 0.125).finished();
  machine.stiffness = (Eigen::Matrix2d{} << 2, -1, -1, 2).finished();
  machine.directions = (Eigen::Matrix2d{} << 1, 1, 0, angle).finished();
  machine.friction_N = Eigen::Vector2d{0.75, 0.25};
  return machine;
}

LinearMachine<> one_direction() {
  LinearMachine<> machine = two_masses(0);
  machine.directions = Eigen::Vector2d{1, 0};
  machine.friction_N = Eigen::VectorXd::Ones(1);
  return machine;
}

TEST(NearlyParallel, DirectionsThatRoundingCannotTellApartAreOne) {
  for (const double angle : {0.0, 1e-16, -1e-12, 1e-12}) {
    for (const Eigen::Vector2d& v : {Eigen::Vector2d{0, 0}, Eigen::Vector2d{1, -1}}) {
      const State start{0, Eigen::Vector2d{4, 2}, v};
      std::vector<Event> log, log_of_one;
      const auto both = EventDriven<>(two_masses(angle)).run(start, 20, &log);
      const auto one = EventDriven<>(one_direction()).run(start, 20, &log_of_one);
      EXPECT_LT((both.end.q - one.end.q).norm(), 1e-11) << angle;
      EXPECT_EQ(log.size(), 2 * log_of_one.size()) << angle;
      const auto adaptive = Adaptive(two_masses(angle)).run(start, 20);
      EXPECT_LT((adaptive.end.q - one.end.q).norm(), 1e-10) << angle;
    }
  }
}

// Each stick of one of the two directions shifts the other's by its share of the transverse speed: the motion follows
// the angle, and the methods agree.
TEST(NearlyParallel, SmallAnglesChangeTheMotionByTheirSize) {
  const State start{0, Eigen::Vector2d{4, 2}, Eigen::Vector2d{1, -1}};
  const auto one = EventDriven<>(one_direction()).run(start, 20);
  for (const double angle : {1e-11, 1e-9, 1e-7, 1e-5}) {
    const auto both = EventDriven<>(two_masses(angle)).run(start, 20);
    EXPECT_LT((both.end.q - one.end.q).norm(), 100 * angle) << angle;
    const auto adaptive = Adaptive(two_masses(angle)).run(start, 20);
    EXPECT_LT((adaptive.end.q - both.end.q).norm(), 1e-10) << angle;
  }
}

// The faces of what two directions can hold are as near to each other as the directions are. None may be taken for
// another, or nothing bounds what they hold together: here a spring pulls eight times as hard as both.
TEST(NearlyParallel, DirectionsDoNotHoldMoreThanTheirFrictions) {
  for (const double angle : {1e-3, 1e-6, 1e-8, 1e-11}) {
    LinearMachine<> machine = two_masses(angle), single = one_direction();
    for (LinearMachine<>* m : {&machine, &single}) {
      m->damping.setZero();
      m->stiffness = 2 * Eigen::Matrix2d::Identity();
    }
    const State start{0, Eigen::Vector2d{4, 0}, Eigen::Vector2d::Zero()};
    const Eigen::VectorXd moved = EventDriven<>(single).run(start, 2).end.q;
    EXPECT_LT((EventDriven<>(machine).run(start, 2).end.q - moved).norm(), 100 * angle) << angle;
    EXPECT_LT((Adaptive(machine).run(start, 2).end.q - moved).norm(), 100 * angle + 1e-9) << angle;
  }
}

}  // namespace
}  // namespace nearly_parallel_test
