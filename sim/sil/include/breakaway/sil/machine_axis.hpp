// An axis of a machine that several drives push, as the mechanism of its drive.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "breakaway/sil/braked_mechanism.hpp"
#include "breakaway/sil/driven_machine.hpp"

namespace breakaway::sil {

class MachineAxis final : public BrakedMechanism {
 public:
  MachineAxis(std::shared_ptr<DrivenMachine> machine, std::size_t axis, Mounting mounting)
      : BrakedMechanism{mounting}, machine_{std::move(machine)}, axis_{axis} {}

  // Mechanism, in the drive's direction

  void advance_to(double time_s, const model::AppliedForce& /*force*/) override { machine_->advance_to(time_s); }
  void change_force(const model::AppliedForce& force) override {
    note_segment(force, state().velocity_m_s);
    model::AppliedForce along = force;
    along.constant_N = on_axis_N(force.constant_N);
    along.transient_N = on_axis_N(force.transient_N);
    machine_->change_force(axis_, along);
  }
  double position_m() const override { return sign() * state().position_m; }

  void release(double time_s) override {
    if (!released()) machine_->open_brake(time_s);
    BrakedMechanism::release(time_s);
  }

  // In the axis' direction

  AxisState state() const override { return machine_->state_of(axis_); }
  double friction_level_N() const override { return machine_->friction_on_N(axis_); }

 private:
  std::shared_ptr<DrivenMachine> machine_;
  std::size_t axis_;
};

}  // namespace breakaway::sil
