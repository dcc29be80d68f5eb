#include "compliant_equation.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/motion/tie.hpp"

namespace breakaway::motion {
namespace {

// In steady sliding the bend equals what the level bears, to the rounding of a step.
constexpr double slack_rounding = 1e-11;
// Less than this of damping the wrong way, for a part of a step, is lost in the step's error.
constexpr double slack_between_ends = 1e-7;

}  // namespace

CompliantEquation::CompliantEquation(const model::CompliantPlant& plant, const CompliantPiece& piece,
                                     const model::AppliedForce& force, double time_s)
    : plant_{plant}, piece_{piece}, force_{force}, time_s_{time_s}, transient_N_{force.transient_at_N(time_s)} {
  for (std::size_t i = 0; i < piece_ends; ++i) {
    const auto end = static_cast<PieceEnd>(i);
    if (may_come(end)) watched_[watched_count_++] = end;
  }
}

double CompliantEquation::drive_N(double tau_s) const {
  if (transient_N_ == 0) return force_.constant_N;
  return force_.constant_N + transient_N_ * std::exp(-tau_s / force_.time_constant_s);
}

double CompliantEquation::coupling_N(const CompliantVector& y) const {
  if (!plant_.load || !meshed()) return 0;
  const model::ElasticCoupling& coupling = plant_.load->coupling;
  const double rate_m_s = y[velocity] - y[load_velocity];
  if (coupling.gap_m == 0) return coupling.stiffness_N_per_m * y[deflection] + coupling.damping_Ns_per_m * rate_m_s;
  return piece_.side * coupling.pressing_N(y[deflection], rate_m_s, piece_.side);
}

double CompliantEquation::push_on_motor_N(double tau_s, const CompliantVector& y) const {
  double push_N = drive_N(tau_s);
  if (plant_.ripple.amplitude != 0) push_N *= 1 + plant_.ripple.at(y[position]);
  if (plant_.cogging.amplitude != 0) push_N += plant_.cogging.at(y[position]);
  return push_N + plant_.force_N - coupling_N(y);
}

double CompliantEquation::motor_level_N(double tau_s, const CompliantVector& y) const {
  const Asked asked{tau_s, y[position], y[velocity]};
  if (asked == asked_level_) return level_N_;
  asked_level_ = asked;
  return level_N_ = piece_.motor.law->level_N(time_s_ + tau_s, y[position], piece_.motor.direction * y[velocity]);
}

double CompliantEquation::load_level_N(double tau_s, const CompliantVector& y) const {
  return piece_.load.law->level_N(time_s_ + tau_s, y[position] - y[deflection],
                                  piece_.load.direction * y[load_velocity]);
}

double CompliantEquation::slack(double tau_s, const CompliantVector& y) const {
  return 1 - piece_.motor.direction * plant_.presliding->load_share(y[bend], motor_level_N(tau_s, y));
}

// The smooth continuation of Presliding::force_N() beyond the end of the piece.
double CompliantEquation::friction_N(double tau_s, const CompliantVector& y) const {
  if (!plant_.presliding) return piece_.motor.direction * motor_level_N(tau_s, y);
  const model::Presliding& p = *plant_.presliding;
  const double bent_N = p.stiffness_N_per_m * y[bend];
  if (!piece_.damped || p.damping_Ns_per_m == 0) return bent_N;
  return bent_N + p.damping_Ns_per_m * y[velocity] * slack(tau_s, y);
}

void CompliantEquation::operator()(double tau_s, const CompliantVector& y, CompliantVector& derivative) {
  ++evaluations_;
  derivative = {};
  if (!piece_.motor.sticks()) {
    derivative[position] = y[velocity];
    derivative[velocity] = (push_on_motor_N(tau_s, y) - friction_N(tau_s, y)) / plant_.mass_kg;
  }
  if (plant_.load && !piece_.load.sticks()) {
    const double friction_N = piece_.load.law ? piece_.load.direction * load_level_N(tau_s, y) : 0;
    derivative[load_velocity] = (coupling_N(y) - friction_N) / plant_.load->mass_kg;
  }
  if (plant_.load) derivative[deflection] = y[velocity] - y[load_velocity];
  if (plant_.presliding)
    derivative[bend] =
        plant_.presliding->bend_rate_m_s(y[bend], y[velocity], piece_.motor.direction, motor_level_N(tau_s, y));
  // Each subdivision of a step asks in the order of time, the finest one last.
  if (tau_s <= asked_s_) ended_inside_ = false;
  asked_s_ = tau_s;
  for (const PieceEnd end : watched())
    ended_inside_ = ended_inside_ || (!(coarse_ && end == PieceEnd::damping) && margin(end, tau_s, y) < 0);
}

// The cubic through both ends, half-way.
bool CompliantEquation::slack_fails_between(const CompliantVector& from, const CompliantVector& to, double step_s) {
  if (!may_come(PieceEnd::damping)) return false;
  CompliantVector slope_from, slope_to, middle;
  (*this)(0, from, slope_from);
  (*this)(step_s, to, slope_to);
  for (std::size_t i = 0; i < components; ++i)
    middle[i] = 0.5 * (from[i] + to[i]) + 0.125 * step_s * (slope_from[i] - slope_to[i]);
  return margin(PieceEnd::damping, 0.5 * step_s, middle) < -slack_between_ends;
}

Matrix<components> CompliantEquation::jacobian(double tau_s, const CompliantVector& y) const {
  Matrix<components> j{};
  if (!piece_.motor.sticks()) j[position][velocity] = 1;
  if (plant_.load) {
    j[deflection][velocity] = 1;
    j[deflection][load_velocity] = -1;
    if (meshed()) {
      const model::ElasticCoupling& c = plant_.load->coupling;
      const double motor = piece_.motor.sticks() ? 0 : 1 / plant_.mass_kg;
      const double load = piece_.load.sticks() ? 0 : 1 / plant_.load->mass_kg;
      j[velocity] = {0, -c.damping_Ns_per_m * motor, -c.stiffness_N_per_m * motor, c.damping_Ns_per_m * motor, 0};
      j[load_velocity] = {0, c.damping_Ns_per_m * load, c.stiffness_N_per_m * load, -c.damping_Ns_per_m * load, 0};
    }
  }
  if (!plant_.presliding) return j;
  const model::Presliding& p = *plant_.presliding;
  const int s = piece_.motor.direction;
  const double level_N = motor_level_N(tau_s, y), u = p.load_share(y[bend], level_N);
  CompliantVector faster = y;
  const double change_m_s = 1e-6 * std::abs(y[velocity]) + slowest_m_s(level_N);
  faster[velocity] += change_m_s;
  const double slope = (motor_level_N(tau_s, faster) - level_N) / change_m_s / level_N;
  const double grade = slope_of_level_per_m(tau_s, y, level_N);
  const double stretch = piece_.damped ? p.damping_Ns_per_m : 0;
  const double toward = s * y[velocity];
  j[velocity][bend] -= p.stiffness_N_per_m * (1 - stretch * toward / level_N) / plant_.mass_kg;
  j[velocity][velocity] -= stretch * (1 - s * u + toward * u * slope) / plant_.mass_kg;
  j[velocity][position] -= stretch * toward * u * grade / plant_.mass_kg;
  j[bend][position] = toward * u * grade;
  j[bend][bend] = -p.stiffness_N_per_m * toward / level_N;
  j[bend][velocity] = 1 - s * u + toward * u * slope;
  return j;
}

// Of the motor's level by place, as a share of it. Bristles in sliding follow the level at once: were this left out of
// the derivative, linearly implicit steps would lose their order.
double CompliantEquation::slope_of_level_per_m(double tau_s, const CompliantVector& y, double level_N) const {
  const double scale_m = piece_.motor.law->position_scale_m();
  if (!(scale_m < std::numeric_limits<double>::infinity())) return 0;
  CompliantVector farther = y;
  farther[position] += 1e-4 * scale_m;
  return (motor_level_N(tau_s, farther) - level_N) / (1e-4 * scale_m) / level_N;
}

double CompliantEquation::relaxation_per_s(double tau_s, const CompliantVector& y) const {
  double rate_per_s = 0;
  if (plant_.load && meshed())
    rate_per_s = plant_.load->coupling.damping_Ns_per_m * (1 / plant_.mass_kg + 1 / plant_.load->mass_kg);
  if (!plant_.presliding) return rate_per_s;
  const model::Presliding& p = *plant_.presliding;
  const double level_N = motor_level_N(tau_s, y);
  const double damping_Ns_per_m = piece_.damped ? p.damping_Ns_per_m * std::abs(slack(tau_s, y)) : 0;
  return rate_per_s + p.stiffness_N_per_m * std::abs(y[velocity]) / level_N + damping_Ns_per_m / plant_.mass_kg;
}

double CompliantEquation::slowest_m_s(double level_N) const {
  return 1e-9 * level_N / std::sqrt(plant_.presliding->stiffness_N_per_m * plant_.mass_kg);
}

double CompliantEquation::rest_margin_N(const DryContact& contact, double push_N, double tau_s, double place_m) const {
  const int direction = push_N > 0 ? 1 : -1;
  const double level_N = contact.law->varies_with_time() ? contact.law->breakaway_N(time_s_ + tau_s, place_m, direction)
                                                         : contact.rest_level_N[direction > 0];
  return widened(level_N) - std::abs(push_N);
}

double CompliantEquation::edge_margin_m(const DryContact& contact, double place_m) {
  return contact.direction > 0 ? contact.range_m.upper_m - place_m : place_m - contact.range_m.lower_m;
}

bool CompliantEquation::may_come(PieceEnd end) const {
  const auto edge = [](const DryContact& contact) {
    if (!contact.law || contact.direction == 0) return false;
    return std::isfinite(contact.direction > 0 ? contact.range_m.upper_m : contact.range_m.lower_m);
  };
  const bool gap = plant_.load && plant_.load->coupling.gap_m != 0;
  switch (end) {
    case PieceEnd::motor:
      return true;
    case PieceEnd::load:
      return plant_.load && piece_.load.law;
    case PieceEnd::damping:
      return plant_.presliding && plant_.presliding->damping_Ns_per_m != 0;
    case PieceEnd::teeth:
      return gap;
    case PieceEnd::press:
      return gap && piece_.side != 0;
    case PieceEnd::motor_edge:
      return edge(piece_.motor);
    case PieceEnd::load_edge:
      return edge(piece_.load);
    case PieceEnd::count:
      break;
  }
  return false;
}

double CompliantEquation::margin(PieceEnd end, double tau_s, const CompliantVector& y) const {
  const double load_m = y[position] - y[deflection];
  switch (end) {
    case PieceEnd::motor:
      if (plant_.presliding)
        return piece_.motor.direction * y[velocity] + slowest_m_s(piece_.motor.law->bounds().upper_N);
      return piece_.motor.sticks() ? rest_margin_N(piece_.motor, push_on_motor_N(tau_s, y), tau_s, y[position])
                                   : piece_.motor.direction * y[velocity];
    case PieceEnd::load:
      return piece_.load.sticks() ? rest_margin_N(piece_.load, push_on_load_N(y), tau_s, load_m)
                                  : piece_.load.direction * y[load_velocity];
    case PieceEnd::damping:
      return (piece_.damped ? slack(tau_s, y) : -slack(tau_s, y)) + slack_rounding;
    case PieceEnd::teeth:
      return piece_.side == 0 ? 0.5 * plant_.load->coupling.gap_m - std::abs(y[deflection])
                              : plant_.load->coupling.squeeze_m(y[deflection], piece_.side);
    case PieceEnd::press: {
      const double rate_m_s = y[velocity] - y[load_velocity];
      const double pressing_N = plant_.load->coupling.pressing_N(y[deflection], rate_m_s, piece_.side);
      return piece_.pressing ? pressing_N : -pressing_N;
    }
    case PieceEnd::motor_edge:
      return edge_margin_m(piece_.motor, y[position]);
    case PieceEnd::load_edge:
      return edge_margin_m(piece_.load, load_m);
    case PieceEnd::count:
      break;
  }
  return 0;
}

}  // namespace breakaway::motion
