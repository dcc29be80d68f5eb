// The most work that a pulse can do on a motor whose load hangs on a spring with backlash, where nothing shows the
// motor's travel: the theorem of the unread motor in THEORY.md. Friction may vary as it likes and swing the load, so
// long as it is at least what is stated; the joint may be stiffer, and its gap smaller. Both masses may be greater in
// the same proportion, as those of a class are; with a greater load alone the bound may rise a little.
#pragma once

namespace breakaway::design {

struct PulseWork {
  double motor_kg, load_kg;  // the lightest of axes whose load has the same share of the mass
  double stiffness_N_per_m;  // at least
  double gap_m;              // at most
  double motor_friction_N;   // at least, less the most that acts beside the drive
  double load_friction_N;    // at least
  double held_N;             // what the spring pulls at most at rest
  double lag_s;              // time constant of the current loop, at most

  // Of the motor when the pulse ends, with a force that is at least the friction of both.
  double most_travel_m(double force_N, double pulse_s) const;
  // Of the drive, in the pulse and while its force dies away afterwards.
  double most_J(double force_N, double pulse_s) const;

 private:
  double strained_J() const { return held_N * held_N / (2 * stiffness_N_per_m); }
  double late_J(double force_N) const;
  double given_J(double force_N, double pulled_N) const;
};

}  // namespace breakaway::design
