#include "axis_truth.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/node_laws.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/sil/braked_mechanism.hpp"
#include "breakaway/sil/simulated_network.hpp"

namespace breakaway::campaign {
namespace {

using Long = long double;

struct Point {
  Long t, x, v;
};

// A mass on dry friction under a force over time, position and speed.
class FineAxis {
 public:
  FineAxis(Long mass, const model::FrictionLaw& friction, Point start) : mass_{mass}, friction_{friction}, at_{start} {}

  const Point& at() const { return at_; }
  void hit(Long impulse) { at_.v += impulse / mass_; }

  // Moves on to `end` in steps of at most `longest`, or to the first stop. True: it came to a stop.
  template <class Force>
  bool move(Long end, Long longest, const Force& force, bool until_stop) {
    while (at_.t < end) {
      const Long h = std::min(longest, end - at_.t);
      const int direction = direction_under(force);
      if (direction == 0) {
        wait(h, force);
        continue;
      }
      const Point next = step(direction, h, force);
      if (direction * next.v > 0) {
        at_ = next;
        continue;
      }
      stop(direction, h, force);
      if (until_stop) return true;
    }
    at_.t = end;
    return false;
  }

 private:
  // 0 while it sticks.
  template <class Force>
  int direction_under(const Force& force) {
    if (at_.v != 0) return at_.v > 0 ? 1 : -1;
    const Long push = force(at_.t, at_.x, Long{0});
    const int direction = push > 0 ? 1 : -1;
    return std::fabs(push) > level(at_) ? direction : 0;
  }

  // Lets time pass while it sticks, up to the instant of break-away.
  template <class Force>
  void wait(Long h, const Force& force) {
    const Long start = at_.t;
    at_.t = start + h;
    if (direction_under(force) == 0) return;
    Long before = 0, after = h;
    for (int i = 0; i < 60; ++i) {
      const Long middle = (before + after) / 2;
      at_.t = start + middle;
      (direction_under(force) == 0 ? before : after) = middle;
    }
    at_.t = start + after;
  }

  Long level(const Point& p) const {
    return static_cast<Long>(
        friction_.level_N(static_cast<double>(p.t), static_cast<double>(p.x), static_cast<double>(std::fabs(p.v))));
  }

  template <class Force>
  Point step(int direction, Long h, const Force& force) const {
    const auto slope = [&](const Point& p) { return (force(p.t, p.x, p.v) - direction * level(p)) / mass_; };
    const auto ahead = [&](Long share, Long v, Long a) {
      return Point{at_.t + share * h, at_.x + share * h * v, at_.v + share * h * a};
    };
    const Long v1 = at_.v, a1 = slope(at_);
    const Point p2 = ahead(Long{0.5}, v1, a1);
    const Long a2 = slope(p2);
    const Point p3 = ahead(Long{0.5}, p2.v, a2);
    const Long a3 = slope(p3);
    const Point p4 = ahead(1, p3.v, a3);
    const Long a4 = slope(p4);
    return {at_.t + h, at_.x + h * (v1 + 2 * p2.v + 2 * p3.v + p4.v) / 6, at_.v + h * (a1 + 2 * a2 + 2 * a3 + a4) / 6};
  }

  template <class Force>
  void stop(int direction, Long h, const Force& force) {
    Long before = 0, after = h;
    for (int i = 0; i < 70; ++i) {
      const Long middle = (before + after) / 2;
      (direction * step(direction, middle, force).v > 0 ? before : after) = middle;
    }
    at_ = step(direction, after, force);
    at_.v = 0;
  }

  Long mass_;
  model::FrictionLaw friction_;
  Point at_;
};

// The axis behind its brake, as a drive moves it.
class FineMechanism final : public sil::BrakedMechanism {
 public:
  FineMechanism(const config::Axis& axis, const scenario::AxisWorld& world)
      : BrakedMechanism{sil::Mounting::straight},
        axis_{axis.mass_kg, world.friction, {0, world.position_m, world.velocity_m_s}} {}

  void advance_to(double time_s, const model::AppliedForce& force) override {
    if (!moves_at(time_s)) return;
    const model::AppliedForce applied = on_axis(force);
    Long longest = 1e-5L;
    if (applied.transient_N != 0) longest = std::min(longest, static_cast<Long>(applied.time_constant_s) / 40);
    axis_.move(
        since_release_s(time_s), longest,
        [&](Long t, Long, Long) {
          const Long gone = (t - applied.start_s) / applied.time_constant_s;
          return applied.constant_N + (applied.transient_N == 0 ? 0 : applied.transient_N * std::exp(-gone));
        },
        false);
  }
  double position_m() const override { return static_cast<double>(axis_.at().x); }
  sil::AxisState state() const override {
    return {position_m(), static_cast<double>(axis_.at().v), axis_.at().v == 0, 0};
  }
  double friction_level_N() const override { return std::numeric_limits<double>::quiet_NaN(); }

 private:
  FineAxis axis_;
};

}  // namespace

std::vector<double> true_kicks_m(const scenario::Scenario& s, std::size_t most) {
  const config::Axis& axis = s.node.axes.front();
  const auto p = config::axis_parameters<double>(s.node, axis);
  const auto table =
      design::build_k3_table<double>({p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N},
                                     p.stick_radius_upper_m())
          .table;
  law::AxisController<double> controller{p, table};
  const scenario::AxisWorld& world = s.worlds.front();
  FineAxis motion{axis.mass_kg, world.friction, {0, world.position_m, world.velocity_m_s}};
  const double target_m = axis.controller.target_m;
  controller.shift_target(target_m);
  std::vector<double> kicks_m;
  const auto force = [&](Long, Long x, Long v) {
    return -p.stiffness_N_per_m * (x - target_m) - controller.damping_Ns_per_m() * v;
  };
  const auto answer = [&] {
    const Point& at = motion.at();
    const auto out = controller.update({static_cast<double>(at.x - target_m), static_cast<double>(at.v)});
    if (!out.kicked) return;
    kicks_m.push_back(static_cast<double>(at.x));
    motion.hit(out.impulse_Ns);
  };
  answer();
  const Long longest = 2e-4L * std::sqrt(static_cast<Long>(axis.mass_kg) / p.stiffness_N_per_m);
  while (kicks_m.size() < most && motion.move(s.run->duration_s, longest, force, true)) answer();
  return kicks_m;
}

std::vector<double> true_way_m(const scenario::Scenario& s, std::size_t samples) {
  const auto node = std::make_unique<config::AnyNode<float>>(config::flashed<float>(s.node));
  using Loop = firmware::ControlLoop<sil::SimulatedNetwork::Port, cia402::Drive<float>, law::AxisController<float>,
                                     float, config::most_axes>;
  sil::SimulatedNetwork network{*s.bus};
  Loop loop{network.controller_port(), node->loop};
  firmware::add_axes(loop, *node);
  FineMechanism mechanism{s.node.axes.front(), s.worlds.front()};
  network.add_drive(*s.worlds.front().drive, mechanism);
  const auto id = *loop.axis(0);
  loop.set_target_counts(id, 0);
  const hal::Duration period = node->loop.network.period;
  hal::Time now{};
  const auto step = [&] {
    network.begin_period(loop, now);
    now += period;
  };
  bool enabled = false;
  while (!(enabled && loop.status(id).running) && now < hal::Time{} + std::chrono::seconds{10}) {
    if (!enabled && loop.status(id).feedback.state != hal::DriveState::configuring) {
      loop.request_enable(id);
      enabled = true;
    }
    step();
  }
  mechanism.release(hal::seconds(network.bus().now()));
  std::vector<double> way_m{mechanism.position_m()};
  while (way_m.size() < samples) {
    step();
    way_m.push_back(mechanism.position_m());
  }
  return way_m;
}

}  // namespace breakaway::campaign
