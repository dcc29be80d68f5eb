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

constexpr int most_decisions_at_once = 40;
constexpr std::size_t most_events = 20'000;

template <class Real>
Matrix<Real> widened(const Eigen::MatrixXd& from) {
  Matrix<Real> result(static_cast<std::size_t>(from.rows()), static_cast<std::size_t>(from.cols()));
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    for (Eigen::Index j = 0; j < from.cols(); ++j) {
      result(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) = Real(from(i, j));
    }
  }
  return result;
}

// A quantity constant + by . x, where x is the integral of e for a load, which stays between -1 and 1 while the mode
// lasts, and e itself for a speed, which stays positive.
template <class Real>
struct Guard {
  Real constant = 0;
  Vector<Real> by;
  Real scale = 1;
  std::optional<std::size_t> slider = {};  // the direction whose speed it is
};

template <class Real>
class Reference {
 public:
  static constexpr double noise = Rounding<Real>::noise;

  Reference(const Machine& machine, const State& start, double end_s, double most_work)
      : end_s_{end_s}, most_work_{most_work} {
    const Matrix<Real> mass = widened<Real>(machine.mass);
    to_position_ = inverse_cholesky_factor(mass);
    const Matrix<Real> back = to_position_.transposed();
    machine_.stiffness = to_position_ * widened<Real>(machine.stiffness) * back;
    machine_.damping = to_position_ * widened<Real>(machine.damping) * back;
    machine_.force = to_position_ * widened<Real>(stability::constant_force(machine)).column(0);
    const Matrix<Real> directions = to_position_ * widened<Real>(machine.directions);
    for (Eigen::Index i = 0; i < machine.frictions(); ++i) {
      Vector<Real> push = directions.column(static_cast<std::size_t>(i));
      for (Real& x : push) x *= Real(machine.friction_N[i]);
      if (norm(push) > 0) machine_.pushes.push_back(std::move(push));
    }
    machine_.rate = square_root(machine_.stiffness.row_norm()) + machine_.damping.row_norm();
    q_ = to_position_ * (mass * widened<Real>(start.q).column(0));
    v_ = to_position_ * (mass * widened<Real>(start.v).column(0));
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
    Vector<Real> integral, e;
    Real since_s = 0;
    std::vector<Jet<Real>> jets;  // of the guards
  };

  Real speed(std::size_t i) const { return dot(machine_.pushes[i], v_) / norm(machine_.pushes[i]); }
  bool stands(std::size_t i) const { return magnitude(speed(i)) <= Real(100 * noise) * greatest_speed_; }

  bool decide(const std::vector<bool>& stopped) {
    for (std::size_t i = 0; i < signs_.size(); ++i) {
      if (!stopped[i] && signs_[i] == 0) signs_[i] = speed(i) > 0 ? 1 : -1;
    }
    return decide_friction(machine_, q_, v_, stopped, signs_);
  }

  void begin_mode() {
    auto& found = modes_[signs_mask()];
    if (!found) found = std::make_unique<StickMode<Real>>(machine_, signs_);
    mode_ = found.get();
    Vector<Real> w = mode_->free.transposed() * v_;
    v_ = mode_->free * w;
    applied_ = machine_.force;
    for (std::size_t i = 0; i < signs_.size(); ++i) add_scaled(applied_, -signs_[i], machine_.pushes[i]);
    Vector<Real> balance = applied_;
    add_scaled(balance, -1, machine_.stiffness * q_);
    add_scaled(balance, -1, machine_.damping * v_);
    const Vector<Real> acceleration = mode_->free.transposed() * balance;
    load_ = -(mode_->held.transposed() * balance);
    const std::size_t n = w.size();
    at_ = {Vector<Real>(2 * n), Vector<Real>(2 * n), 0, {}};
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
    at_.jets.clear();
    ahead_level_ = -1;
    for (std::size_t i = 0; i < signs_.size(); ++i) {
      if (signs_[i] == 0) continue;
      Guard<Real> guard;
      guard.by = mode_->free.transposed() * machine_.pushes[i];
      for (Real& x : guard.by) x *= signs_[i] / (norm(machine_.pushes[i]) * mode_->omega);
      guard.by.resize(2 * guard.by.size());
      guard.scale = greatest_speed_ + force_scale_ * mode_->flow.shortest_s();
      guard.slider = i;
      guards_.push_back(std::move(guard));
    }
    return mode_->held.columns() == 0 || set_load_guards();
  }

  bool set_load_guards() {
    HoldingForces<Real> forces{mode_->held_columns, mode_->held.columns()};
    Vector<Real> now = load_;
    add_scaled(now, 1, mode_->load_by_integral * at_.integral);
    if (!forces.optimise(now)) return false;
    gauge_ = magnitude((forces.forces() * now)[0]);
    const Matrix<Real> by_integral = forces.forces() * mode_->load_by_integral;
    const Vector<Real> constant = forces.forces() * load_;
    for (std::size_t i = 0; i < constant.size(); ++i) {
      guards_.push_back({constant[i], by_integral.row(i), 1 + magnitude(constant[i]), {}});
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
    Vector<Real> z(n), w(n);
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

  // The step at `level` in two halves. False leaves the state as it was, and the first half for the next attempt.
  bool take_long_step(int level) {
    if (at_.jets.empty()) at_.jets = jets(at_);
    Point middle = ahead_level_ == level - 1 ? std::move(ahead_) : moved(at_, level - 1);
    Point end = ahead_level_ == level ? std::move(ahead_) : moved(middle, level - 1);
    if (!stays_in_mode(middle, end, mode_->flow.step_s(level))) {
      ahead_ = std::move(middle);
      ahead_level_ = level - 1;
      return false;
    }
    at_ = std::move(end);
    ahead_level_ = -1;
    note_scales_here();
    return true;
  }

  bool stays_in_mode(const Point& middle, const Point& end, Real length) const {
    for (std::size_t g = 0; g < guards_.size(); ++g) {
      const Jet<Real>&a = at_.jets[g], &b = middle.jets[g], &c = end.jets[g];
      if (guards_[g].slider ? !stays_positive(a, b, c, length)
                            : !stays_positive(below_one(a, 1), below_one(b, 1), below_one(c, 1), length) ||
                                  !stays_positive(below_one(a, -1), below_one(b, -1), below_one(c, -1), length)) {
        return false;
      }
    }
    return true;
  }

  // What is left of 1, on one side.
  static Jet<Real> below_one(const Jet<Real>& jet, int side) {
    return {1 - side * jet.value, -side * jet.first, -side * jet.second};
  }

  Point moved(const Point& from, int level) {
    auto step = mode_->flow.propagate(level, from.e);
    add_scaled(step.integral, 1, from.integral);
    Point to{std::move(step.integral), std::move(step.end), from.since_s + mode_->flow.step_s(level), {}};
    to.jets = jets(to);
    return to;
  }

  std::vector<Jet<Real>> jets(const Point& point) {
    const Vector<Real> rate = mode_->flow.generator() * point.e, bend = mode_->flow.generator() * rate;
    result_.work += static_cast<double>((2 * rate.size() + 3 * guards_.size()) * rate.size());
    std::vector<Jet<Real>> result;
    result.reserve(guards_.size());
    for (const Guard<Real>& g : guards_) {
      result.push_back(g.slider
                           ? Jet<Real>{dot(g.by, point.e), dot(g.by, rate), dot(g.by, bend)}
                           : Jet<Real>{g.constant + dot(g.by, point.integral), dot(g.by, point.e), dot(g.by, rate)});
    }
    return result;
  }

  // The shortest step, or less to an event or to the end, by Taylor series.
  std::optional<Outcome> take_short_step(Real left_s) {
    const std::vector<Vector<Real>> series = mode_->flow.series(at_.e);
    const bool last = left_s <= mode_->flow.shortest_s();
    Real first_s = last ? left_s : mode_->flow.shortest_s();
    const Guard<Real>* cause = nullptr;
    for (const Guard<Real>& guard : guards_) {
      for (const auto& p : margins(guard, series)) {
        const auto zero = first_zero(p, first_s, Real(noise) * guard.scale);
        if (!zero) continue;
        first_s = *zero;
        cause = &guard;
      }
    }
    advance(series, first_s);
    if (cause == nullptr) return last ? std::optional{Outcome::time_up} : std::nullopt;
    if (!cause->slider) return after_limit();
    stopping_ = *cause->slider;
    return Outcome::event;
  }

  // One choice of holding forces is at its limit: another may still hold.
  std::optional<Outcome> after_limit() {
    if (!set_guards()) return Outcome::unclear;
    if (gauge_ >= 1 - Real(10 * noise)) return Outcome::event;
    if (++exchanges_ > 100'000) return Outcome::unclear;
    return std::nullopt;
  }

  // The polynomials that stay positive: that of a speed, or what is left of a load's two limits.
  std::vector<Vector<Real>> margins(const Guard<Real>& guard, const std::vector<Vector<Real>>& series) const {
    Vector<Real> p(series.size());
    if (guard.slider) {
      for (std::size_t k = 0; k < series.size(); ++k) p[k] = dot(guard.by, series[k]);
      return {std::move(p)};
    }
    p[0] = guard.constant + dot(guard.by, at_.integral);
    for (std::size_t k = 1; k < series.size(); ++k) p[k] = dot(guard.by, series[k - 1]) / static_cast<double>(k);
    Vector<Real> left = -p;
    left[0] += 1;
    p[0] += 1;
    return {std::move(p), std::move(left)};
  }

  void advance(const std::vector<Vector<Real>>& series, Real h) {
    Vector<Real> e(at_.e.size());
    Real power = 1;
    for (std::size_t k = 0; k < series.size(); ++k) {
      add_scaled(e, power, series[k]);
      power *= h;
      add_scaled(at_.integral, power / static_cast<double>(k + 1), series[k]);
    }
    at_.e = std::move(e);
    at_.since_s += h;
    at_.jets.clear();
    ahead_level_ = -1;
    result_.work += static_cast<double>(series.size() * at_.e.size() * (at_.e.size() + guards_.size()));
  }

  void note_scales() {
    greatest_speed_ = larger(greatest_speed_, norm(v_));
    greatest_q_ = larger(greatest_q_, largest(to_position_ * q_));
    greatest_v_ = larger(greatest_v_, largest(to_position_ * v_));
  }

  static Vector<Quad> widest(const Vector<Real>& from) { return {from.begin(), from.end()}; }

  ReferenceRun finish(ReferenceEnd end) {
    result_.end = end;
    if (end == ReferenceEnd::at_rest) v_.assign(v_.size(), 0);
    result_.q = widest(to_position_ * q_);
    result_.v = widest(to_position_ * v_);
    result_.rest_s = static_cast<double>(time_s_);
    result_.greatest_q = static_cast<double>(greatest_q_);
    result_.greatest_v = static_cast<double>(greatest_v_);
    for (const auto& [mask, mode] : modes_) result_.work += mode->flow.work();
    return result_;
  }

  NormalMachine<Real> machine_;
  Matrix<Real> to_position_;  // L^-T
  Real end_s_, time_s_ = 0;
  double most_work_;
  Vector<Real> q_, v_;
  std::vector<int> signs_;
  std::map<std::uint32_t, std::unique_ptr<StickMode<Real>>> modes_;
  StickMode<Real>* mode_ = nullptr;
  Vector<Real> applied_, load_, q_begin_, v_begin_;
  Real force_scale_ = 0, gauge_ = 0, greatest_speed_ = 0, greatest_q_ = 0, greatest_v_ = 0;
  Point at_, ahead_;      // where the motion is, and a point that it reaches by a step of `ahead_level_`
  int ahead_level_ = -1;  // none for a negative one
  std::vector<Guard<Real>> guards_;
  std::vector<bool> stopped_;
  std::size_t stopping_ = static_cast<std::size_t>(-1);
  int at_once_ = 0, exchanges_ = 0;
  ReferenceRun result_;
};

}  // namespace

template <class Real>
ReferenceRun run_reference(const Machine& machine, const State& start, double end_s, double most_work) {
  return Reference<Real>{machine, start, end_s, most_work}.run();
}

template ReferenceRun run_reference<Fast>(const Machine&, const State&, double, double);
template ReferenceRun run_reference<Quad>(const Machine&, const State&, double, double);

}  // namespace breakaway::campaign
