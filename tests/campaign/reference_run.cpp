#include "reference_run.hpp"

#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "friction_decision.hpp"
#include "guard_roots.hpp"
#include "holding_forces.hpp"
#include "stick_mode.hpp"

namespace breakaway::campaign {
namespace {

constexpr double noise = 1e-25;  // of a quantity's scale: zero to rounding
constexpr int most_decisions_at_once = 40;
constexpr std::size_t most_events = 20'000;

Matrix widened(const Eigen::MatrixXd& from) {
  Matrix result(static_cast<std::size_t>(from.rows()), static_cast<std::size_t>(from.cols()));
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    for (Eigen::Index j = 0; j < from.cols(); ++j) {
      result(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) = Real(from(i, j));
    }
  }
  return result;
}

// A quantity constant + by_integral . I + by_e . e that is positive while the mode lasts.
struct Guard {
  Real constant = 0;
  Vector by_integral, by_e;
  Real scale = 1;
  bool of_load = false;
};

class Reference {
 public:
  Reference(const Machine& machine, const State& start, double end_s, double most_work)
      : end_s_{end_s}, most_work_{most_work} {
    const Matrix mass = widened(machine.mass);
    to_position_ = inverse_cholesky_factor(mass);
    const Matrix back = to_position_.transposed();
    machine_.stiffness = to_position_ * widened(machine.stiffness) * back;
    machine_.damping = to_position_ * widened(machine.damping) * back;
    machine_.force = to_position_ * widened(stability::constant_force(machine)).column(0);
    const Matrix directions = to_position_ * widened(machine.directions);
    for (Eigen::Index i = 0; i < machine.frictions(); ++i) {
      Vector push = directions.column(static_cast<std::size_t>(i));
      for (Real& x : push) x *= Real(machine.friction_N[i]);
      if (norm(push) > 0) machine_.pushes.push_back(std::move(push));
    }
    machine_.rate = square_root(machine_.stiffness.row_norm()) + machine_.damping.row_norm();
    q_ = to_position_ * (mass * widened(start.q).column(0));
    v_ = to_position_ * (mass * widened(start.v).column(0));
    time_s_ = Real(start.time_s);
    signs_.assign(machine_.pushes.size(), 0);
    to_position_ = back;
  }

  ReferenceRun run() {
    note_scales();
    std::vector<bool> stopped;
    for (std::size_t i = 0; i < signs_.size(); ++i) stopped.push_back(stands(i));
    if (!decide(stopped)) return finish(ReferenceEnd::unclear);
    while (result_.events < most_events) {
      begin_mode();
      if (resting()) return finish(ReferenceEnd::at_rest);
      const Real before_s = time_s_;
      const Outcome outcome = follow_mode();
      note_scales();
      if (outcome == Outcome::time_up) return finish(ReferenceEnd::time_up);
      if (outcome == Outcome::too_long) return finish(ReferenceEnd::too_long);
      if (outcome == Outcome::unclear) return finish(ReferenceEnd::unclear);
      at_once_ = time_s_ - before_s > Real(noise) * time_s_ ? 0 : at_once_ + 1;
      if (at_once_ > most_decisions_at_once || !decide(std::exchange(stopped_, {}))) {
        return finish(ReferenceEnd::unclear);
      }
      ++result_.events;
    }
    return finish(ReferenceEnd::too_long);
  }

 private:
  enum class Outcome { event, time_up, too_long, unclear };

  struct Point {
    Vector integral, e;
    Real since_s = 0;
  };

  Real speed(std::size_t i) const { return dot(machine_.pushes[i], v_) / norm(machine_.pushes[i]); }
  bool stands(std::size_t i) const { return magnitude(speed(i)) <= Real(1e-23) * greatest_speed_; }

  bool decide(const std::vector<bool>& stopped) {
    for (std::size_t i = 0; i < signs_.size(); ++i) {
      if (!stopped[i] && signs_[i] == 0) signs_[i] = speed(i) > 0 ? 1 : -1;
    }
    return decide_friction(machine_, q_, v_, stopped, signs_);
  }

  void begin_mode() {
    auto& found = modes_[signs_mask()];
    if (!found) found = std::make_unique<StickMode>(machine_, signs_);
    mode_ = found.get();
    Vector w = mode_->free.transposed() * v_;
    v_ = mode_->free * w;
    applied_ = machine_.force;
    for (std::size_t i = 0; i < signs_.size(); ++i) add_scaled(applied_, -signs_[i], machine_.pushes[i]);
    Vector balance = applied_;
    add_scaled(balance, -1, machine_.stiffness * q_);
    add_scaled(balance, -1, machine_.damping * v_);
    const Vector acceleration = mode_->free.transposed() * balance;
    load_ = -(mode_->held.transposed() * balance);
    const std::size_t n = w.size();
    at_ = {Vector(2 * n), Vector(2 * n), 0};
    for (std::size_t i = 0; i < n; ++i) {
      at_.e[i] = mode_->omega * w[i];
      at_.e[n + i] = acceleration[i];
    }
    q_begin_ = q_;
    v_begin_ = v_;
    force_scale_ = norm(applied_) + norm(machine_.stiffness * q_) + norm(machine_.damping * v_);
  }

  std::uint32_t signs_mask() const {
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < signs_.size(); ++i) mask |= (signs_[i] == 0 ? 1U : 0U) << i;
    return mask;
  }

  bool resting() const {
    for (const int sign : signs_) {
      if (sign != 0) return false;
    }
    if (at_.e.empty()) return true;
    const std::size_t n = at_.e.size() / 2;
    for (std::size_t i = 0; i < n; ++i) {
      if (magnitude(at_.e[i]) > Real(noise) * mode_->omega * greatest_speed_) return false;
      if (magnitude(at_.e[n + i]) > Real(noise) * force_scale_) return false;
    }
    return true;
  }

  bool set_guards() {
    guards_.clear();
    const std::size_t n = mode_->free.columns();
    for (std::size_t i = 0; i < signs_.size(); ++i) {
      if (signs_[i] == 0) continue;
      Guard guard;
      guard.by_integral = Vector(2 * n);
      guard.by_e = mode_->free.transposed() * machine_.pushes[i];
      for (Real& x : guard.by_e) x *= signs_[i] / (norm(machine_.pushes[i]) * mode_->omega);
      guard.by_e.resize(2 * n);
      guard.scale = greatest_speed_ + force_scale_ * mode_->flow.shortest_s();
      guards_.push_back(std::move(guard));
    }
    return mode_->held.columns() == 0 || set_load_guards();
  }

  bool set_load_guards() {
    HoldingForces forces{mode_->held_columns, mode_->held.columns()};
    Vector now = load_;
    add_scaled(now, 1, mode_->load_by_integral * at_.integral);
    if (!forces.optimise(now)) return false;
    gauge_ = magnitude((forces.forces() * now)[0]);
    const Matrix by_integral = forces.forces() * mode_->load_by_integral;
    const Vector constant = forces.forces() * load_;
    for (std::size_t i = 0; i < constant.size(); ++i) {
      Vector row = by_integral.transposed().column(i);
      for (const double sign : {1.0, -1.0}) {
        Guard guard;
        guard.constant = 1 + Real(sign) * constant[i];
        guard.by_integral = row;
        for (Real& x : guard.by_integral) x *= Real(sign);
        guard.by_e = Vector(row.size());
        guard.scale = 1 + magnitude(constant[i]);
        guard.of_load = true;
        guards_.push_back(std::move(guard));
      }
    }
    return true;
  }

  Outcome follow_mode() {
    if (!set_guards()) return Outcome::unclear;
    int level = 0;
    while (true) {
      if (result_.work + mode_->flow.work() > most_work_) return leave(Outcome::too_long);
      const Real left_s = end_s_ - (time_s_ + at_.since_s);
      if (left_s <= 0) return leave(Outcome::time_up);
      while (level > 0 && mode_->flow.step_s(level) > left_s) --level;
      if (level > 0) {
        level += take_long_step(level) ? 1 : -1;
        continue;
      }
      const std::optional<Outcome> ended = take_short_step(left_s);
      if (ended) return leave(*ended);
      level = 1;
    }
  }

  void set_state_here() {
    const std::size_t n = at_.e.size() / 2;
    Vector z(n), w(n);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = at_.integral[i] / mode_->omega;
      w[i] = at_.e[i] / mode_->omega;
    }
    q_ = q_begin_;
    add_scaled(q_, 1, mode_->free * z);
    v_ = mode_->free * w;
  }

  void note_scales_here() {
    set_state_here();
    note_scales();
  }

  Outcome leave(Outcome outcome) {
    set_state_here();
    time_s_ += at_.since_s;
    if (outcome == Outcome::event) {
      note_scales();
      for (std::size_t i = 0; i < signs_.size(); ++i) {
        stopped_.push_back(signs_[i] == 0 || i == stopping_ || stands(i));
      }
    }
    stopping_ = machine_.pushes.size();
    if (largest(v_) > Real(1e200)) return Outcome::unclear;
    return outcome;
  }

  // The step at `level` in two halves; false leaves everything as it was.
  bool take_long_step(int level) {
    const Point begin = at_;
    const Point middle = moved(begin, level - 1), end = moved(middle, level - 1);
    const std::vector<Jet> first = jets(begin), second = jets(middle), third = jets(end);
    for (std::size_t g = 0; g < guards_.size(); ++g) {
      if (!stays_positive(first[g], second[g], third[g], mode_->flow.step_s(level))) return false;
    }
    at_ = end;
    note_scales_here();
    return true;
  }

  Point moved(const Point& from, int level) {
    ModeFlow::Step step = mode_->flow.propagate(level, from.e);
    add_scaled(step.integral, 1, from.integral);
    return {std::move(step.integral), std::move(step.end), from.since_s + mode_->flow.step_s(level)};
  }

  std::vector<Jet> jets(const Point& point) const {
    const Vector rate = mode_->flow.generator() * point.e, bend = mode_->flow.generator() * rate;
    std::vector<Jet> result;
    for (const Guard& g : guards_) {
      result.push_back({g.constant + dot(g.by_integral, point.integral) + dot(g.by_e, point.e),
                        dot(g.by_integral, point.e) + dot(g.by_e, rate), dot(g.by_integral, rate) + dot(g.by_e, bend)});
    }
    return result;
  }

  // The shortest step, or less to an event or to the end, by Taylor series.
  std::optional<Outcome> take_short_step(Real left_s) {
    const std::vector<Vector> series = mode_->flow.series(at_.e);
    const bool last = left_s <= mode_->flow.shortest_s();
    const Real step_s = last ? left_s : mode_->flow.shortest_s();
    Real first_s = step_s;
    const Guard* cause = nullptr;
    std::size_t slider = 0, stopping = machine_.pushes.size();
    for (const Guard& guard : guards_) {
      std::size_t direction = machine_.pushes.size();
      if (!guard.of_load) {
        while (signs_[slider] == 0) ++slider;
        direction = slider++;
      }
      const auto zero = first_zero(polynomial(guard, series), first_s, Real(noise) * guard.scale);
      if (!zero) continue;
      first_s = *zero;
      cause = &guard;
      stopping = direction;
    }
    advance(series, first_s);
    if (cause == nullptr) return last ? std::optional{Outcome::time_up} : std::nullopt;
    if (!cause->of_load) {
      stopping_ = stopping;
      return Outcome::event;
    }
    return after_limit();
  }

  // One choice of holding forces is at its limit: another may still hold.
  std::optional<Outcome> after_limit() {
    if (!set_guards()) return Outcome::unclear;
    if (gauge_ >= 1 - Real(1e-24)) return Outcome::event;
    if (++exchanges_ > 100'000) return Outcome::unclear;
    return std::nullopt;
  }

  Vector polynomial(const Guard& guard, const std::vector<Vector>& series) const {
    Vector p(series.size());
    p[0] = guard.constant + dot(guard.by_integral, at_.integral);
    for (std::size_t k = 0; k < series.size(); ++k) {
      p[k] += dot(guard.by_e, series[k]);
      if (k > 0) p[k] += dot(guard.by_integral, series[k - 1]) / static_cast<double>(k);
    }
    return p;
  }

  void advance(const std::vector<Vector>& series, Real h) {
    Vector e(at_.e.size());
    Real power = 1;
    for (std::size_t k = 0; k < series.size(); ++k) {
      add_scaled(e, power, series[k]);
      power *= h;
      add_scaled(at_.integral, power / static_cast<double>(k + 1), series[k]);
    }
    at_.e = std::move(e);
    at_.since_s += h;
    result_.work += static_cast<double>(series.size() * at_.e.size() * (at_.e.size() + guards_.size()));
  }

  void note_scales() {
    greatest_speed_ = larger(greatest_speed_, norm(v_));
    greatest_q_ = larger(greatest_q_, largest(to_position_ * q_));
    greatest_v_ = larger(greatest_v_, largest(to_position_ * v_));
  }

  ReferenceRun finish(ReferenceEnd end) {
    result_.end = end;
    if (end == ReferenceEnd::at_rest) v_.assign(v_.size(), 0);
    result_.q = to_position_ * q_;
    result_.v = to_position_ * v_;
    result_.rest_s = static_cast<double>(time_s_);
    result_.greatest_q = static_cast<double>(greatest_q_);
    result_.greatest_v = static_cast<double>(greatest_v_);
    for (const auto& [mask, mode] : modes_) result_.work += mode->flow.work();
    return result_;
  }

  NormalMachine machine_;
  Matrix to_position_;  // L^-T
  Real end_s_, time_s_ = 0;
  double most_work_;
  Vector q_, v_;
  std::vector<int> signs_;
  std::map<std::uint32_t, std::unique_ptr<StickMode>> modes_;
  StickMode* mode_ = nullptr;
  Vector applied_, load_, q_begin_, v_begin_;
  Real force_scale_ = 0, gauge_ = 0, greatest_speed_ = 0, greatest_q_ = 0, greatest_v_ = 0;
  Point at_;
  std::vector<Guard> guards_;
  std::vector<bool> stopped_;
  std::size_t stopping_ = static_cast<std::size_t>(-1);
  int at_once_ = 0, exchanges_ = 0;
  ReferenceRun result_;
};

}  // namespace

ReferenceRun run_reference(const Machine& machine, const State& start, double end_s, double most_work) {
  return Reference{machine, start, end_s, most_work}.run();
}

}  // namespace breakaway::campaign
