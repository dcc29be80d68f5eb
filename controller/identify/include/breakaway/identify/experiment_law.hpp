// ExperimentLaw: an experiment as the law of an axis in a control loop, which keeps a copy of its law; whoever owns the
// experiment may end it.
#pragma once

#include "breakaway/identify/experiment.hpp"

namespace breakaway::identify {

template <class Scalar>
class ExperimentLaw {
 public:
  // The experiment must outlive every copy.
  explicit ExperimentLaw(Experiment<Scalar>& experiment) noexcept : experiment_{&experiment} {}

  law::ControlOutput<Scalar> update(const law::Measurement<Scalar>& z) noexcept { return experiment_->update(z); }
  void shift_target(Scalar shift_m) noexcept { experiment_->shift_target(shift_m); }
  void limit_force(Scalar force_N) noexcept { experiment_->limit_force(force_N); }
  void reset() noexcept { experiment_->reset(); }
  law::ControlFault fault() const noexcept { return experiment_->fault(); }
  law::Mode mode() const noexcept { return experiment_->mode(); }
  Scalar period_s() const noexcept { return experiment_->period_s(); }
  Scalar encoder_resolution_m() const noexcept { return experiment_->encoder_resolution_m(); }
  Scalar max_force_N() const noexcept { return experiment_->max_force_N(); }

 private:
  Experiment<Scalar>* experiment_;
};

}  // namespace breakaway::identify
