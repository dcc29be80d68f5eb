#include "breakaway/sil/driven_machine.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "breakaway/hybrid/refused.hpp"
#include "breakaway/stability/dense.hpp"

namespace breakaway::sil {
namespace {

using Eigen::Index;

// In units of that of the lag: an odd number, so that no machine of round numbers has it.
constexpr double other_rate = 2.2360679774997896;

// How hybrid::Budget and motion::WorkBudget compare: each is a few seconds.
constexpr double multiplications_of_an_evaluation = hybrid::Budget::usual_work / motion::WorkBudget::usual_work;

// Squares of such coordinates are still numbers.
constexpr double farthest = 1e150;

// The mass that a drive feels.
double felt_mass_kg(const stability::LinearMachine<>& machine, const Eigen::VectorXd& push) {
  const Eigen::VectorXd response = stability::dense::Cholesky(machine.mass).solve(push);
  return 1 / push.dot(response);
}

}  // namespace

DrivenMachine::DrivenMachine(scenario::CoupledMachine coupled, std::vector<Axis> axes)
    : coupled_{std::move(coupled)},
      axes_{std::move(axes)},
      lags_{lags_of(coupled_, axes_)},
      integrator_{with_lags()},
      forces_(axes_.size()),
      state_{coupled_.start},
      closed_brakes_{axes_.size()} {
  const stability::LinearMachine<>& m = coupled_.machine;
  for (Index i = 0; i < m.frictions(); ++i) {
    if (m.directions.col(i).dot(state_.v) == 0) sticking_ |= hybrid::only(i);
  }
  for (const Axis& axis : axes_)
    couplings_.push_back({directions_on(coordinates_coupled_to(axis.place)), directions_on(axis.place.push)});
}

std::vector<DrivenMachine::Lag> DrivenMachine::lags_of(const scenario::CoupledMachine& coupled,
                                                       const std::vector<Axis>& axes) {
  std::vector<Lag> lags;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].lag_s > 0) lags.push_back({i, felt_mass_kg(coupled.machine, axes[i].place.push)});
  }
  return lags;
}

stability::LinearMachine<> DrivenMachine::with_lags() const {
  const Index n = coupled_.machine.coordinates(), all = n + static_cast<Index>(lags_.size());
  const auto widened = [&](const Eigen::MatrixXd& matrix) {
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(all, all);
    wide.topLeftCorner(n, n) = matrix;
    return wide;
  };
  stability::LinearMachine<> machine = coupled_.machine;
  machine.mass = widened(machine.mass);
  machine.damping = widened(machine.damping);
  machine.stiffness = widened(machine.stiffness);
  machine.directions.conservativeResizeLike(Eigen::MatrixXd::Zero(all, machine.frictions()));
  machine.force_N = with_zeros(stability::constant_force(coupled_.machine));
  for (std::size_t i = 0; i < lags_.size(); ++i) {
    const Index lag = n + static_cast<Index>(i);
    const Axis& axis = axes_[lags_[i].axis];
    machine.mass(lag, lag) = lags_[i].mass_kg;
    machine.damping(lag, lag) = (1 + other_rate) * lags_[i].mass_kg / axis.lag_s;
    machine.stiffness(lag, lag) = other_rate * lags_[i].mass_kg / (axis.lag_s * axis.lag_s);
    machine.stiffness.col(lag).head(n) = -axis.place.push * (lags_[i].mass_kg / (axis.lag_s * axis.lag_s));
  }
  return machine;
}

Eigen::VectorXd DrivenMachine::with_zeros(const Eigen::VectorXd& vector) const {
  Eigen::VectorXd longer = Eigen::VectorXd::Zero(vector.size() + static_cast<Index>(lags_.size()));
  longer.head(vector.size()) = vector;
  return longer;
}

// Coordinates are coupled where an entry of a matrix joins them, or a direction of friction.
Eigen::VectorXd DrivenMachine::coordinates_coupled_to(const scenario::MachinePlace& place) const {
  const stability::LinearMachine<>& m = coupled_.machine;
  Eigen::MatrixXd joins = m.mass.cwiseAbs() + m.damping.cwiseAbs() + m.stiffness.cwiseAbs() +
                          m.directions.cwiseAbs() * m.directions.cwiseAbs().transpose();
  joins += joins.transpose().eval();
  Eigen::VectorXd touched = place.push.cwiseAbs() + place.read.cwiseAbs();
  for (Index i = 0; i < m.coordinates(); ++i)
    touched = (touched + joins * touched).unaryExpr([](double share) { return share > 0 ? 1.0 : 0.0; });
  return touched;
}

// The directions with friction that touch one of these coordinates.
hybrid::DirectionSet DrivenMachine::directions_on(const Eigen::VectorXd& coordinates) const {
  const stability::LinearMachine<>& m = coupled_.machine;
  hybrid::DirectionSet directions = 0;
  for (Index i = 0; i < m.frictions(); ++i) {
    if (m.friction_N[i] > 0 && m.directions.col(i).cwiseAbs().dot(coordinates.cwiseAbs()) > 0)
      directions |= hybrid::only(i);
  }
  return directions;
}

void DrivenMachine::open_brake(double time_s) {
  origin_s_ = time_s;
  --closed_brakes_;
}

void DrivenMachine::change_force(std::size_t axis, const model::AppliedForce& force) { forces_[axis] = force; }

Eigen::VectorXd DrivenMachine::force_N() const {
  Eigen::VectorXd force_N = stability::constant_force(coupled_.machine);
  for (std::size_t i = 0; i < axes_.size(); ++i) force_N += axes_[i].place.push * forces_[i].constant_N;
  return with_zeros(force_N);
}

stability::MachineState<Eigen::Dynamic> DrivenMachine::state_with_lags() const {
  const Index n = state_.q.size();
  stability::MachineState<Eigen::Dynamic> state{state_.time_s, with_zeros(state_.q), with_zeros(state_.v)};
  for (std::size_t i = 0; i < lags_.size(); ++i) {
    const std::size_t axis = lags_[i].axis;
    const Index lag = n + static_cast<Index>(i);
    const double speed_m_s =
        forces_[axis].transient_at_N(origin_s_ + state_.time_s) * axes_[axis].lag_s / lags_[i].mass_kg;
    state.q[lag] = speed_m_s * axes_[axis].lag_s;
    state.v[lag] = -speed_m_s;
  }
  return state;
}

hybrid::Outcome<Eigen::Dynamic> DrivenMachine::follow(double end_s, std::vector<hybrid::Event>& events) {
  const auto run = [&](const hybrid::Budget& budget) {
    return integrator_.resume(state_with_lags(), sticking_, end_s, &events, budget);
  };
  if (budget_ == nullptr) return run(hybrid::Budget{});
  try {
    auto outcome = run(hybrid::Budget{std::max(1.0, budget_->left() * multiplications_of_an_evaluation)});
    budget_->spend(end_s, outcome.work / multiplications_of_an_evaluation);
    return outcome;
  } catch (const hybrid::RefusedForWork&) {
    budget_->spend(state_.time_s, budget_->left());  // it would take this and more
    budget_->refuse(state_.time_s);
  }
}

void DrivenMachine::advance_to(double time_s) {
  const double end_s = time_s - origin_s_;
  if (closed_brakes_ > 0 || !(end_s > state_.time_s)) return;
  integrator_.set_force(force_N());
  const hybrid::DirectionSet held_before = sticking_;
  std::vector<hybrid::Event> events;
  const auto end = follow(end_s, events).end;
  const Index n = state_.q.size();
  state_ = {end_s, end.q.head(n), end.v.head(n)};
  if (!(state_.q.cwiseAbs().maxCoeff() < farthest && state_.v.cwiseAbs().maxCoeff() < farthest))
    throw hybrid::Refused{"the [machine] flies apart: by t = " + hybrid::shown(end_s) +
                              " s it has come to the end of the range of numbers",
                          "correct its negative stiffness or damping, or shorten [run] duration_s"};
  count_slips(held_before, events);
}

// What slid when a piece of motion began, or ended it sliding, and is not in the log, had been let go by its force.
void DrivenMachine::count_slips(hybrid::DirectionSet held_before, const std::vector<hybrid::Event>& events) {
  for (Coupling& coupling : couplings_) {
    hybrid::DirectionSet held = held_before;
    for (const hybrid::Event& event : events) {
      const auto direction = hybrid::only(event.direction);
      if ((coupling.pushed & direction) == 0) continue;
      const bool let_go = event.kind != hybrid::EventKind::slip && (held & direction) != 0;
      coupling.slips += (let_go ? 1U : 0U) + (event.kind == hybrid::EventKind::stick ? 0U : 1U);
      held = event.kind == hybrid::EventKind::stick ? held | direction : held & ~direction;
    }
    coupling.slips += static_cast<std::uint64_t>(std::popcount(coupling.pushed & held & ~sticking_));
  }
}

AxisState DrivenMachine::state_of(std::size_t axis) const {
  const Eigen::VectorXd& read = axes_[axis].place.read;
  const Coupling& coupling = couplings_[axis];
  return {read.dot(state_.q), read.dot(state_.v), holds(coupling), coupling.slips};
}

double DrivenMachine::friction_on_N(std::size_t axis) const {
  const stability::LinearMachine<>& m = coupled_.machine;
  const Eigen::VectorXd& push = axes_[axis].place.push;
  double force_N = 0;
  for (Index i = 0; i < m.frictions(); ++i) {
    const double share = m.directions.col(i).dot(push) / push.squaredNorm();
    if (share == 0 || m.friction_N[i] == 0) continue;
    if (hybrid::contains(sticking_, i)) return std::numeric_limits<double>::quiet_NaN();
    force_N += share * std::copysign(m.friction_N[i], m.directions.col(i).dot(state_.v));
  }
  return std::abs(force_N);
}

}  // namespace breakaway::sil
