#include "breakaway/motion/compliant_axis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "breakaway/motion/tie.hpp"
#include "compliant_equation.hpp"

namespace breakaway::motion {
namespace {

// Shares of the speed in the norm of the energy, for a tolerance of 1: the friction of a Slide is judged by the speed.
constexpr double explicit_share = 100, implicit_share = 1000;
// An explicit step is stable up to some tens of relaxation times. A linearly implicit one, which costs about twice as
// much, pays where it is longer than this many.
constexpr double relaxations_a_step = 60;
constexpr double force_rounding = 1e-15;  // of a sum of forces
constexpr int most_pieces_at_once = 100;
constexpr int most_refusals = 200;

int sign_of(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

void require_sound(const model::AppliedForce& force) {
  if (!std::isfinite(force.constant_N + force.transient_N + force.start_s))
    throw InputError{"the force is not finite; correct it"};
  if (force.has_feedback()) throw InputError{"the force has feedback; a compliant axis takes what a drive makes"};
  if (force.transient_N != 0 && !(force.time_constant_s > 0)) throw InputError{"time_constant_s must be positive"};
}

}  // namespace

class CompliantAxis::Motion {
 public:
  Motion(model::CompliantPlant plant, model::FrictionLaw friction, const SlideState& initial, double tolerance);

  void advance_to(double time_s, const model::AppliedForce& force);
  CompliantState state() const;
  bool sticking() const;
  double friction_force_N() const;
  double energy_J() const;
  const CompliantCounters& counters() const { return counters_; }

 private:
  struct Trial {
    ExtrapolatedStep<CompliantVector> step;
    bool ended_inside = false;
  };

  bool bristles() const { return plant_.presliding.has_value(); }
  double load_place_m() const { return y_[position] - y_[deflection]; }
  CompliantEquation equation() const { return {plant_, piece_, force_, time_.sum_s}; }

  void move(double duration_s, double end_s);
  double longest_step_s(double duration_s) const;
  double speed_scale_m_s(CompliantEquation& equation, double step_s) const;
  double forces_N() const;
  CompliantVector floor(double scale_m_s, double tolerance, double step_s) const;
  bool pays_to_be_implicit(double step_s) const {
    return equation().relaxation_per_s(0, y_) * step_s > relaxations_a_step;
  }
  Trial try_step(double step_s, bool implicit) const;
  void accept(const CompliantVector& y, double step_s, std::optional<double> end_s);
  std::optional<PieceEnd> first_end(const CompliantVector& y, double step_s) const;
  void go_to_end(PieceEnd end, double step_s, bool implicit);
  double resolution(PieceEnd end, double step_s) const;

  void end_piece(PieceEnd end);
  void stop_motor();
  void stop_load();
  void turn_bristles();
  void meet_or_part();
  void release(DryContact& contact, double push_N, double place_m, bool is_motor);
  void face_pushed_bristles(double push_N);
  void release_what_is_pushed();
  void face(DryContact& contact, double place_m);
  void pass_edge(DryContact& contact);
  void change_laws();

  model::CompliantPlant plant_;
  CompliantPiece piece_;
  CompliantVector y_{};
  SummedTime time_;
  double tolerance_;
  model::AppliedForce force_;
  // What each method suggests to try next.
  double explicit_step_s_ = std::numeric_limits<double>::max();
  double implicit_step_s_ = std::numeric_limits<double>::max();
  int at_once_ = 0;  // pieces that ended without time passing
  bool held_ = false;
  CompliantCounters counters_;
};

CompliantAxis::Motion::Motion(model::CompliantPlant plant, model::FrictionLaw friction, const SlideState& initial,
                              double tolerance)
    : plant_{std::move(plant)}, time_{initial.time_s}, tolerance_{tolerance} {
  if (!(tolerance >= 1e-14 && tolerance <= 1e-2))
    throw InputError{"tolerance is " + std::to_string(tolerance) + "; give a number from 1e-14 to 1e-2"};
  model::require_valid(plant_);
  if (!std::isfinite(initial.time_s + initial.position_m + initial.velocity_m_s))
    throw InputError{"the start is not finite; correct it"};
  y_[position] = initial.position_m;
  y_[velocity] = y_[load_velocity] = initial.velocity_m_s;
  piece_.motor.law.emplace(std::move(friction));
  piece_.motor.direction = sign_of(initial.velocity_m_s);
  if (bristles() && piece_.motor.direction == 0) piece_.motor.direction = 1;
  if (plant_.load) {
    piece_.load.law = std::move(plant_.load->friction);
    piece_.load.direction = sign_of(initial.velocity_m_s);
  }
  for (DryContact* contact : {&piece_.motor, &piece_.load})
    if (contact->law) contact->next_change_s = initial.time_s;
  change_laws();
}

// --- time

void CompliantAxis::Motion::advance_to(double time_s, const model::AppliedForce& force) {
  if (!std::isfinite(time_s)) throw InputError{"time_s is not finite; correct it"};
  if (time_s < time_.sum_s) throw InputError{"time_s lies before the state's time; give a later one"};
  require_sound(force);
  force_ = force;
  at_once_ = 0;
  release_what_is_pushed();
  while (time_.until(time_s) > 0) {
    const double change_s = std::min(piece_.motor.next_change_s, piece_.load.next_change_s);
    const double end_s = std::min(time_s, change_s);
    move(time_.until(end_s), end_s);
    if (time_.sum_s < change_s) continue;
    change_laws();
    release_what_is_pushed();
  }
  const bool held = sticking();
  if (bristles() && held_ && !held) ++counters_.slips;
  held_ = held;
}

// Moves by one step or to the end of a piece, at most to end_s.
void CompliantAxis::Motion::move(double duration_s, double end_s) {
  const double longest_s = longest_step_s(duration_s);
  const bool implicit = pays_to_be_implicit(std::min(longest_s, implicit_step_s_));
  double& next_s = implicit ? implicit_step_s_ : explicit_step_s_;
  double step_s = std::min(longest_s, next_s);
  if (!implicit) implicit_step_s_ *= 2;  // it may pay again
  for (int refusals = 0; refusals < most_refusals; ++refusals) {
    const Trial trial = try_step(step_s, implicit);
    if (!trial.step.converged) {
      step_s = next_s = std::min(trial.step.suggested_step, 0.7 * step_s);
      if (implicit && !pays_to_be_implicit(step_s)) return;  // the explicit one is to try
      continue;
    }
    if (const auto end = first_end(trial.step.state, step_s)) return go_to_end(*end, step_s, implicit);
    if (trial.ended_inside) {
      step_s *= 0.5;
      continue;
    }
    const bool cut_short = step_s < next_s;
    next_s = cut_short ? std::max(next_s, trial.step.suggested_step) : trial.step.suggested_step;
    at_once_ = 0;
    return accept(trial.step.state, step_s, step_s == duration_s ? std::optional{end_s} : std::nullopt);
  }
  throw InputError{
      "the motion of the axis cannot be followed: its steps fell below the resolution of time; lower its "
      "stiffness or its damping"};
}

// What stands still lets steps grow without end, and laws that change with time would go unseen.
double CompliantAxis::Motion::longest_step_s(double duration_s) const {
  double longest_s = duration_s;
  for (const DryContact* contact : {&piece_.motor, &piece_.load})
    if (contact->law && contact->law->varies_with_time())
      longest_s = std::min(longest_s, 0.5 * contact->law->time_scale_s());
  return longest_s;
}

// The speed in the norm of the energy, and what the step adds to it.
double CompliantAxis::Motion::speed_scale_m_s(CompliantEquation& equation, double step_s) const {
  CompliantVector slope;
  equation(0, y_, slope);
  const double mass_kg = plant_.mass_kg;
  return std::sqrt(2 * energy_J() / mass_kg) + std::abs(slope[velocity]) * step_s;
}

// What an acceleration is the difference of.
double CompliantAxis::Motion::forces_N() const {
  double sum_N = std::abs(force_.constant_N) + std::abs(force_.transient_N) + std::abs(plant_.force_N) +
                 piece_.motor.law->bounds().upper_N + plant_.cogging.amplitude;
  if (plant_.load) sum_N += std::abs(equation().coupling_N(y_));
  if (piece_.load.law) sum_N += piece_.load.law->bounds().upper_N;
  return sum_N;
}

CompliantVector CompliantAxis::Motion::floor(double scale_m_s, double tolerance, double step_s) const {
  const double tiny = std::numeric_limits<double>::min();
  const double speed = tolerance * scale_m_s + force_rounding * forces_N() / plant_.mass_kg * step_s + tiny;
  CompliantVector floor{speed * step_s + tiny, speed, speed * step_s + tiny, speed, tiny};
  if (plant_.load) {
    const double mass_kg = std::max(plant_.load->mass_kg, plant_.mass_kg);
    floor[load_velocity] *= std::sqrt(plant_.mass_kg / plant_.load->mass_kg);
    const double swing_s = std::sqrt(mass_kg / plant_.load->coupling.stiffness_N_per_m);
    floor[deflection] = speed * std::min(step_s, swing_s) + tiny;
  } else {
    floor[deflection] = floor[load_velocity] = 1;
  }
  if (!bristles()) {
    floor[bend] = 1;
    return floor;
  }
  const double stiffness_N_per_m = plant_.presliding->stiffness_N_per_m;
  const double most_m = piece_.motor.law->bounds().upper_N / stiffness_N_per_m;
  floor[bend] = std::min(speed * std::sqrt(plant_.mass_kg / stiffness_N_per_m), tolerance * most_m) + tiny;
  return floor;
}

CompliantAxis::Motion::Trial CompliantAxis::Motion::try_step(double step_s, bool implicit) const {
  CompliantEquation motion = equation();
  const double scale_m_s = speed_scale_m_s(motion, step_s);
  Trial trial;
  if (!implicit) {
    trial.step = extrapolated_step(motion, 0, y_, step_s, 0, floor(scale_m_s, explicit_share * tolerance_, step_s));
    trial.ended_inside = motion.ended_inside();
    return trial;
  }
  motion.watch_coarsely();
  trial.step = linearly_implicit_step<components>(motion, motion.jacobian(0, y_), 0, y_, step_s,
                                                  floor(scale_m_s, implicit_share * tolerance_, step_s));
  trial.ended_inside = motion.ended_inside() || motion.slack_fails_between(y_, trial.step.state, step_s);
  return trial;
}

void CompliantAxis::Motion::accept(const CompliantVector& y, double step_s, std::optional<double> end_s) {
  ++counters_.steps;
  y_ = y;
  if (end_s) {
    time_ = {*end_s};
  } else {
    time_.pass(step_s);
  }
}

// --- ends of pieces

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
  if (++at_once_ > most_pieces_at_once)
    throw InputError{"the axis turns round without end at one instant; give its load or its bristles more damping"};
  ++counters_.pieces;
  end_piece(end);
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

// --- dry friction

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

// --- what it is

CompliantState CompliantAxis::Motion::state() const {
  const bool load = plant_.load.has_value();
  return {time_.sum_s,
          y_[position],
          y_[velocity],
          load ? load_place_m() : y_[position],
          load ? y_[load_velocity] : y_[velocity],
          y_[bend]};
}

bool CompliantAxis::Motion::sticking() const {
  if (piece_.load.law && !piece_.load.sticks()) return false;
  if (!bristles()) return piece_.motor.sticks();
  const CompliantEquation motion = equation();
  const model::Presliding& p = *plant_.presliding;
  const double level_N = motion.motor_level_N(0, y_), push_N = motion.push_on_motor_N(0, y_);
  const double vibration_N = std::hypot(std::sqrt(p.stiffness_N_per_m * plant_.mass_kg) * y_[velocity],
                                        p.stiffness_N_per_m * y_[bend] - push_N);
  return std::abs(push_N) + vibration_N < level_N;
}

double CompliantAxis::Motion::friction_force_N() const {
  const CompliantEquation motion = equation();
  if (bristles() || !piece_.motor.sticks()) return -motion.friction_N(0, y_);
  return -std::clamp(motion.push_on_motor_N(0, y_), -piece_.motor.rest_level_N[0], piece_.motor.rest_level_N[1]);
}

double CompliantAxis::Motion::energy_J() const {
  double energy_J = 0.5 * plant_.mass_kg * y_[velocity] * y_[velocity];
  if (bristles()) energy_J += plant_.presliding->energy_J(y_[bend]);
  if (!plant_.load) return energy_J;
  return energy_J + 0.5 * plant_.load->mass_kg * y_[load_velocity] * y_[load_velocity] +
         plant_.load->coupling.energy_J(y_[deflection]);
}

// --- the axis

CompliantAxis::CompliantAxis(model::CompliantPlant plant, model::FrictionLaw friction, SlideState initial,
                             double tolerance)
    : motion_{std::make_unique<Motion>(std::move(plant), std::move(friction), initial, tolerance)} {}
CompliantAxis::CompliantAxis(CompliantAxis&&) noexcept = default;
CompliantAxis& CompliantAxis::operator=(CompliantAxis&&) noexcept = default;
CompliantAxis::~CompliantAxis() = default;

void CompliantAxis::advance_to(double time_s, const model::AppliedForce& force) { motion_->advance_to(time_s, force); }
CompliantState CompliantAxis::state() const { return motion_->state(); }
bool CompliantAxis::sticking() const { return motion_->sticking(); }
double CompliantAxis::friction_force_N() const { return motion_->friction_force_N(); }
double CompliantAxis::energy_J() const { return motion_->energy_J(); }
const CompliantCounters& CompliantAxis::counters() const { return motion_->counters(); }

}  // namespace breakaway::motion
