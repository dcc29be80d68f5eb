// DrivenMachine: a machine with dry friction under the forces of several drives,
//
//   M q'' + C q' + K q - W lambda = f + sum_i s_i u_i(t),   u_i: a held command and a current loop that settles on it.
//
// It is followed from event to event between the changes of the forces. The lag of a current loop is part of the
// machine: each such drive adds a coordinate e of its own that nothing acts on,
//
//   m (d/dt + 1/tau) (d/dt + c/tau) e = 0,  started so that e = e(0) exp(-t/tau),  and its force s_i m e / tau^2
//
// is a term of K. So the force is exact at every instant and no event is missed. The second rate, c/tau, is never
// excited. The mass m is what the drive feels, 1 / (s_i^T M^-1 s_i): then e has the size of the motion that it causes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/model/applied_force.hpp"
#include "breakaway/motion/work_budget.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/braked_mechanism.hpp"

namespace breakaway::sil {

class DrivenMachine {
 public:
  // Of an axis: what its drive pushes and its encoder reads, and the lag of its current loop (0: none).
  struct Axis {
    scenario::MachinePlace place;
    double lag_s = 0;
  };

  // The machine stands, held by the brakes of all drives. Throws InputError for a machine that the event-driven method
  // refuses.
  DrivenMachine(scenario::CoupledMachine coupled, std::vector<Axis> axes);

  // From now on all work is taken from this budget, whose time is since the brakes opened; none: unlimited but for one
  // move. It must outlive the machine. advance_to() then throws motion::OverBudget, too.
  void limit_work(motion::WorkBudget* budget) { budget_ = budget; }

  // One drive's brake opens; when the last one does, the machine's time starts.
  void open_brake(double time_s);
  // The force of an axis' drive from now on, that is since the last advance_to(), along the axis.
  void change_force(std::size_t axis, const model::AppliedForce& force);
  // Moves on under the forces; nothing happens for a time that was reached already, or under a brake. Throws
  // hybrid::Refused for a motion that cannot be followed.
  void advance_to(double time_s);

  // The machine's n coordinates and their velocities, at the time since the brakes opened.
  const stability::MachineState<Eigen::Dynamic>& state() const { return state_; }

  // What the encoder of an axis sees. It sticks while friction holds everything that is coupled to the axis, by mass,
  // spring, damper or a direction of friction.
  AxisState state_of(std::size_t axis) const;
  // The friction that a drive feels, along what it pushes; NaN while a direction of it sticks.
  double friction_on_N(std::size_t axis) const;

 private:
  struct Coupling {
    hybrid::DirectionSet directions;  // of friction, that touch what is coupled to the axis
    hybrid::DirectionSet pushed;      // those that touch what its drive pushes
    std::uint64_t slips = 0;          // times that one of these began to slide, be it after a reversal
  };

  // The current loop of an axis that lags, and the mass m of its coordinate.
  struct Lag {
    std::size_t axis;
    double mass_kg;
  };

  static std::vector<Lag> lags_of(const scenario::CoupledMachine& coupled, const std::vector<Axis>& axes);
  stability::LinearMachine<> with_lags() const;
  Eigen::VectorXd with_zeros(const Eigen::VectorXd& vector) const;  // for the coordinates of the lags
  Eigen::VectorXd coordinates_coupled_to(const scenario::MachinePlace& place) const;
  hybrid::DirectionSet directions_on(const Eigen::VectorXd& coordinates) const;
  stability::MachineState<Eigen::Dynamic> state_with_lags() const;
  Eigen::VectorXd force_N() const;
  hybrid::Outcome<Eigen::Dynamic> follow(double end_s, std::vector<hybrid::Event>& events);
  bool holds(const Coupling& coupling) const {
    return coupling.directions != 0 && (sticking_ & coupling.directions) == coupling.directions;
  }
  void count_slips(hybrid::DirectionSet held_before, const std::vector<hybrid::Event>& events);

  scenario::CoupledMachine coupled_;
  std::vector<Axis> axes_;
  std::vector<Lag> lags_;
  hybrid::EventDriven<> integrator_;
  std::vector<model::AppliedForce> forces_;  // by axis
  std::vector<Coupling> couplings_;          // by axis
  stability::MachineState<Eigen::Dynamic> state_;
  hybrid::DirectionSet sticking_ = 0;
  std::size_t closed_brakes_;
  motion::WorkBudget* budget_ = nullptr;
  double origin_s_ = 0;  // when the last brake opened
};

}  // namespace breakaway::sil
