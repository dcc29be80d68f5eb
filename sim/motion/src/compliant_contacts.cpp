#include <cmath>

#include "breakaway/motion/tie.hpp"
#include "compliant_motion.hpp"

namespace breakaway::motion {

// From rest, bristles are about to bend the way they are pushed.
void CompliantAxis::Motion::face_pushed_bristles(double push_N) {
  const int direction = sign_of(push_N - plant_.presliding->stiffness_N_per_m * y_[bend]);
  if (direction == 0 || direction == piece_.motor.direction) return;
  piece_.motor.direction = direction;
  face(piece_.motor, y_[position]);
}

void CompliantAxis::Motion::release_what_is_pushed() {
  const CompliantEquation motion = equation();
  if (bristles()) {
    if (y_[velocity] == 0) face_pushed_bristles(motion.push_on_motor_N(0, y_));
  } else if (piece_.motor.sticks()) {
    release(piece_.motor, motion.push_on_motor_N(0, y_), y_[position], true);
  }
  if (plant_.load && piece_.load.sticks()) release(piece_.load, motion.push_on_load_N(y_), load_place_m(), false);
}

void CompliantAxis::Motion::release(DryContact& contact, double push_N, double place_m, bool is_motor) {
  model::FrictionLaw& law = *contact.law;
  if (law.varies_with_time()) face(contact, place_m);
  const int direction = sign_of(push_N);
  // A limit that was just reached is located to a tenth of the tie, on either side.
  if (direction == 0 || std::abs(push_N) <= contact.rest_level_N[direction > 0] * (1 + 0.5 * tie)) return;
  law.face(place_m, direction);
  const double before_N = law.level_N(time_.sum_s, place_m, 0);
  law.on_slip(time_.sum_s);
  law.face(place_m, direction);
  const double after_N = law.level_N(time_.sum_s, place_m, 0);
  // A law that is drawn anew at the slip may hold the axis after all.
  if (!(after_N > before_N && std::abs(push_N) <= widened(after_N))) {
    contact.direction = direction;
    if (is_motor) ++counters_.slips;
  }
  face(contact, place_m);
}

void CompliantAxis::Motion::face(DryContact& contact, double place_m) {
  model::FrictionLaw& law = *contact.law;
  if (contact.direction == 0) {
    for (const int direction : {-1, 1})
      contact.rest_level_N[direction > 0] = law.breakaway_N(time_.sum_s, place_m, direction);
  }
  law.face(place_m, contact.direction);
  contact.next_change_s = law.next_time_change_s();
  contact.range_m = law.range_m();
  if (bristles() && &contact == &piece_.motor) piece_.damped = equation().slack(0, y_) >= 0;
}

// The law goes on from the edge itself, which the place has reached to rounding.
void CompliantAxis::Motion::pass_edge(DryContact& contact) {
  face(contact, contact.direction > 0 ? contact.range_m.upper_m : contact.range_m.lower_m);
}

void CompliantAxis::Motion::change_laws() {
  for (DryContact* contact : {&piece_.motor, &piece_.load}) {
    if (!contact->law || contact->next_change_s > time_.sum_s) continue;
    contact->law->on_time(time_.sum_s);
    face(*contact, contact == &piece_.motor ? y_[position] : load_place_m());
  }
}

}  // namespace breakaway::motion
