// ControlNode: a whole controller on one bus, commanded by another node. A target's main() adds a port and a tick.
#pragma once

#include <cmath>
#include <cstddef>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/law/flashed_axis.hpp"

namespace breakaway::firmware {

// A node of one axis. The axis must outlive it.
template <class Scalar>
struct NodeConfig {
  LoopConfig loop{};
  cia402::DriveConfig<Scalar> drive{};
  AxisLimits<Scalar> limits{};
  const law::FlashedAxis<Scalar>* axis = nullptr;
};

template <hal::CanPort Port, class Scalar = float>
class ControlNode {
 public:
  // Periods between two status frames.
  static constexpr std::uint32_t status_interval = 50;

  ControlNode(Port& port, const NodeConfig<Scalar>& config) noexcept
      : config_{config}, port_{port, config.loop.node_id}, loop_{port_, config.loop} {
    setup_ = check();
    if (!setup_.ok()) return;
    const Controller controller{config.axis->parameters, config.axis->k3_table};
    setup_ = loop_.add_axis(cia402::Drive<Scalar>{config.drive}, controller, config.limits,
                            config.drive.encoder_resolution_m);
    if (setup_.ok()) setup_ = loop_.check_configuration();
  }

  // ok, or what keeps this configuration from running: then step() does nothing. invalid_argument with detail 100 and
  // the law::FlashedAxisError added: the axis is damaged or was not certified like this; 200: drive or loop contradict
  // it; 1 to 9: as cia402::check. bus_overload: as ControlLoop::check_configuration.
  hal::Status setup_status() const noexcept { return setup_; }

  // Once a period.
  void step(hal::Time now) noexcept {
    if (!setup_.ok()) return;
    if (const auto command = port_.take_command(0)) remote_.apply(loop_, *command);
    loop_.step(now);
    if (++periods_ % status_interval == 0)
      static_cast<void>(port_.send(status_frame(loop_, 0, config_.loop.node_id), now + config_.loop.period));
  }

 private:
  using Controller = law::AxisController<Scalar>;
  using Tap = CommandedPort<Port, 1>;
  using Loop = ControlLoop<Tap, cia402::Drive<Scalar>, Controller, Scalar, 1>;

  hal::Status check() const noexcept {
    if (config_.axis == nullptr) return {hal::StatusCode::invalid_argument, 200};
    const auto error = law::verify(*config_.axis);
    if (error != law::FlashedAxisError::none)
      return {hal::StatusCode::invalid_argument, 100 + static_cast<std::uint32_t>(error)};
    if (const hal::Status drive = cia402::check(config_.drive); !drive.ok()) return drive;
    const law::AxisParameters<Scalar>& p = config_.axis->parameters;
    const auto period_ns = static_cast<Scalar>(config_.loop.period.count());
    const bool agree = same(config_.drive.encoder_resolution_m, p.encoder_resolution_m) &&
                       same(config_.drive.max_force_N, p.max_force_N) && same(p.period_s * Scalar(1e9), period_ns) &&
                       config_.loop.period == config_.drive.period;
    return agree ? hal::Status{} : hal::Status{hal::StatusCode::invalid_argument, 200};
  }

  // To the rounding of float.
  static bool same(Scalar a, Scalar b) noexcept { return std::abs(a - b) <= Scalar(1e-6) * std::abs(b); }

  NodeConfig<Scalar> config_;
  Tap port_;
  Loop loop_;
  RemoteAxis remote_;
  hal::Status setup_;
  std::uint32_t periods_ = 0;
};

}  // namespace breakaway::firmware
