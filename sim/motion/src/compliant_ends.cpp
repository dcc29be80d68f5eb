#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "breakaway/motion/tie.hpp"
#include "compliant_motion.hpp"

namespace breakaway::motion {
namespace {

// What keeps an axis from turning round without end, by what it is made of.
std::string remedy_for_turning(const model::CompliantPlant& plant) {
  if (plant.load && plant.presliding) return "give its load or its bristles more damping";
  if (plant.load) return "give its load more damping";
  if (plant.presliding) return "give its bristles more damping";
  return "give it friction that bends before it slides (presliding), or friction and a force that change more slowly";
}

}  // namespace

// What the step runs into first, if anything, as a straight line between its ends tells.
std::optional<PieceEnd> CompliantAxis::Motion::first_end(const CompliantVector& y, double step_s) const {
  CompliantEquation motion = equation();
  std::optional<PieceEnd> first;
  double least = 2;
  for (const PieceEnd end : motion.watched()) {
    const double after = motion.margin(end, step_s, y);
    if (!(after < 0)) continue;
    const double before = std::max(0.0, motion.margin(end, 0, y_));
    const double share = before / (before - after);
    if (share < least) first = end;
    least = std::min(least, share);
  }
  return first;
}

// How near to zero the margin is to be brought.
double CompliantAxis::Motion::resolution(PieceEnd end, double step_s) const {
  CompliantEquation motion = equation();
  const double speed_m_s = 1e-14 * speed_scale_m_s(motion, step_s);
  switch (end) {
    case PieceEnd::motor:
      if (bristles()) return 1e-1 * motion.slowest_m_s(piece_.motor.law->bounds().upper_N);
      return piece_.motor.sticks() ? 0.1 * tie * piece_.motor.rest_level_N[0] : speed_m_s;
    case PieceEnd::load:
      return piece_.load.sticks() ? 0.1 * tie * piece_.load.rest_level_N[0] : speed_m_s;
    case PieceEnd::damping:
      return 1e-12;
    case PieceEnd::press:
      return plant_.load->coupling.stiffness_N_per_m * speed_m_s * step_s;
    default:
      return speed_m_s * step_s;
  }
}

// Newton's method in the length of the step, inside a bracket; each trial is a step from the same start.
void CompliantAxis::Motion::go_to_end(PieceEnd end, double step_s, bool implicit) {
  const double enough = resolution(end, step_s);
  double low_s = 0, high_s = step_s, try_s = step_s;
  Trial trial;
  for (int iteration = 0; iteration < 60; ++iteration) {
    trial = try_step(try_s, implicit);
    CompliantEquation motion = equation();
    const double margin = motion.margin(end, try_s, trial.step.state);
    if (!trial.step.converged) {  // go nearer first
      (implicit ? implicit_step_s_ : explicit_step_s_) = 0.5 * try_s;
      return;
    }
    if (std::abs(margin) <= enough || high_s - low_s <= 1e-15 * high_s) break;
    if (margin < 0) {
      // Another end may come before this one.
      const auto first = first_end(trial.step.state, try_s);
      if (first && *first != end) return go_to_end(*first, try_s, implicit);
    }
    (margin < 0 ? high_s : low_s) = try_s;
    CompliantVector slope;
    motion(try_s, trial.step.state, slope);
    const double ahead_s = 1e-7 * try_s;
    CompliantVector ahead = trial.step.state;
    for (std::size_t i = 0; i < components; ++i) ahead[i] += ahead_s * slope[i];
    const double rate = (motion.margin(end, try_s + ahead_s, ahead) - margin) / ahead_s;
    const double next_s = try_s - margin / rate;
    try_s = next_s > low_s && next_s < high_s ? next_s : 0.5 * (low_s + high_s);
  }
  accept(trial.step.state, try_s, {});
  if (++at_once_ > 2 * most_at_once)
    throw InputError{"the axis turns round without end at one instant; " + remedy_for_turning(plant_)};
  ++counters_.pieces;
  end_piece(end);
}

// Forces start a piece at the rounded time. A force that changes by more than the tie within this rounding may fall
// back behind what it had just reached: friction that was to give way still holds, and is to give way again at that
// instant. What rounding leaves over adds up from piece to piece, and takes the rounded time on before long; where that
// is too little, the axis goes on from the next number. What still turns round without end does so in truth.
void CompliantAxis::Motion::leave_instant(double end_s) {
  ++at_once_;
  const double next_s = std::min(std::nextafter(time_.sum_s, std::numeric_limits<double>::infinity()), end_s);
  const double step_s = time_.until(next_s);
  const Trial trial = try_step(step_s, false);
  if (!trial.step.converged) return;
  accept(trial.step.state, step_s, next_s);
  release_what_is_pushed();
}

void CompliantAxis::Motion::end_piece(PieceEnd end) {
  switch (end) {
    case PieceEnd::motor:
      if (bristles()) return turn_bristles();
      if (piece_.motor.sticks()) return release_what_is_pushed();
      return stop_motor();
    case PieceEnd::load:
      if (piece_.load.sticks()) return release_what_is_pushed();
      return stop_load();
    case PieceEnd::damping:
      piece_.damped = !piece_.damped;
      return;
    case PieceEnd::teeth:
      return meet_or_part();
    case PieceEnd::press:
      piece_.pressing = !piece_.pressing;
      return;
    case PieceEnd::motor_edge:
      return pass_edge(piece_.motor);
    case PieceEnd::load_edge:
      return pass_edge(piece_.load);
    case PieceEnd::count:
      return;
  }
}

void CompliantAxis::Motion::stop_motor() {
  y_[velocity] = 0;
  piece_.motor.direction = 0;
  piece_.motor.law->on_stick(time_.sum_s);
  face(piece_.motor, y_[position]);
  release_what_is_pushed();
}

void CompliantAxis::Motion::stop_load() {
  y_[load_velocity] = 0;
  piece_.load.direction = 0;
  piece_.load.law->on_stick(time_.sum_s);
  face(piece_.load, load_place_m());
  release_what_is_pushed();
}

void CompliantAxis::Motion::turn_bristles() {
  piece_.motor.law->on_stick(time_.sum_s);
  piece_.motor.law->on_slip(time_.sum_s);
  piece_.motor.direction = -piece_.motor.direction;
  face(piece_.motor, y_[position]);
}

void CompliantAxis::Motion::meet_or_part() {
  const bool met = piece_.side == 0;
  const int side = met ? sign_of(y_[deflection]) : piece_.side;
  y_[deflection] = side * 0.5 * plant_.load->coupling.gap_m;
  piece_.side = met ? side : 0;
  piece_.pressing = met;
}

}  // namespace breakaway::motion
