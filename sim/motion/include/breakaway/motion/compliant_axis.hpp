// CompliantAxis: how a model::CompliantPlant moves under the force of a drive: a held command and a current loop that
// settles on it. Positive force pushes towards positive position.
//
// The motion is cut into smooth pieces: where dry friction sticks, slides or turns round, where bristles turn round,
// where the teeth of a backlash meet, press or part, where the friction law jumps. Inside a piece it is integrated by
// extrapolation: explicit (gragg_bulirsch_stoer.hpp), or linearly implicit where bristles or a damper relax much faster
// than the step, so that a bristle of 1e8 N/m under a fast slide needs no micro-steps. The end of a piece is located as
// a root, each trial a step of its own from the same start, so that no step passes a jump.
//
// The error of a step is at most 1e-11 of the speed in the norm of the energy (1e-10 where it is linearly implicit).
// There is no absolute tolerance: scaling lengths, velocities and forces by a power of two scales every result.
//
// Friction with bristles asks its law for the level in the direction of motion. A level of its own at rest, as that of
// shape::static_kinetic, does not show, because bristles never rest; shape::stribeck says what is meant.
#pragma once

#include <cstdint>
#include <memory>

#include "breakaway/input/input_error.hpp"
#include "breakaway/model/applied_force.hpp"
#include "breakaway/model/compliant_plant.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/motion/work_budget.hpp"

namespace breakaway::motion {

struct CompliantState {
  double time_s = 0;
  double position_m = 0;  // of the motor
  double velocity_m_s = 0;
  double load_position_m = 0;  // as the motor's where there is no load
  double load_velocity_m_s = 0;
  double bend_m = 0;  // of the bristles; 0 where there are none
};

struct CompliantCounters {
  std::uint64_t slips = 0;   // times that the motor left rest
  std::uint64_t pieces = 0;  // ends of pieces
  std::uint64_t steps = 0;   // accepted integration steps
  std::uint64_t tries = 0;   // of steps, accepted or not
};

class CompliantAxis {
 public:
  // Motor and load begin at the same place with the same velocity, the bristles unbent. The tolerance is what a Slide
  // would be given for the same accuracy. Throws InputError as model::require_valid(), and unless the start is finite
  // and the tolerance in [1e-14, 1e-2].
  CompliantAxis(model::CompliantPlant plant, model::FrictionLaw friction, SlideState initial,
                double tolerance = Slide::usual_tolerance);
  CompliantAxis(CompliantAxis&&) noexcept;
  CompliantAxis& operator=(CompliantAxis&&) noexcept;
  ~CompliantAxis();

  // Moves on to exactly time_s. Throws InputError for a time_s that is not finite or in the past, a force with feedback
  // or with numbers that are not finite, and when pieces of motion follow each other without end.
  void advance_to(double time_s, const model::AppliedForce& force);

  // From now on all work is taken from this budget, whose time is this axis'; none: unlimited. It must outlive the
  // axis. advance_to() then throws OverBudget, too.
  void limit_work(WorkBudget* budget);

  CompliantState state() const;
  // Says whether friction holds what moves: dry friction sticks, on motor and load; or the bristles bend too little to
  // let go, whatever the motor's own vibration adds.
  bool sticking() const;
  // Returns the friction on the motor under the force of the last advance_to().
  double friction_force_N() const;
  // Returns the kinetic energy, and that of spring and bristles.
  double energy_J() const;
  const CompliantCounters& counters() const;

 private:
  class Motion;
  std::unique_ptr<Motion> motion_;
};

}  // namespace breakaway::motion
