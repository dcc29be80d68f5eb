// ControlNode: a whole controller on one bus, commanded by another node. A target's main() adds a port and a tick.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

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

// Why a node does not run.
enum class NodeError : std::uint8_t {
  none,
  no_axis,
  axis_refused,   // axis_error() says why
  drive_refused,  // drive_error() says why
  period_differs,
  bus_refused,  // bus_fit() says why
};

constexpr std::string_view to_string(NodeError error) noexcept {
  switch (error) {
    case NodeError::none:
      return "the node can run";
    case NodeError::no_axis:
      return "axis is null: give the node its flashed axis";
    case NodeError::axis_refused:
      return "the flashed axis is refused: law::verify() says why";
    case NodeError::drive_refused:
      return "the drive's configuration cannot be used: cia402::check() names the field";
    case NodeError::period_differs:
      return "loop.period is not the period that the axis was designed for: change one of them";
    case NodeError::bus_refused:
      return "the axis does not fit the bus at this period: canopen::check_bus_budget() says why";
  }
  return "unknown node error";
}

template <hal::CanPort Port, class Scalar = float>
class ControlNode {
 public:
  // Periods between two status frames.
  static constexpr std::uint32_t status_interval = 50;

  ControlNode(Port& port, const NodeConfig<Scalar>& config) noexcept
      : config_{config}, port_{port, config.loop.node_id}, loop_{port_, config.loop} {
    error_ = check();
    if (error_ != NodeError::none) return;
    const law::AxisParameters<Scalar>& p = config.axis->parameters;
    const AddAxis added = loop_.add_axis(cia402::Drive<Scalar>{config.drive, config.loop, scale()},
                                         Controller{p, config.axis->k3_table}, config.limits, p.encoder_resolution_m);
    bus_fit_ = loop_.check_configuration();
    if (added != AddAxis::added || bus_fit_ != canopen::BusFit::fits) error_ = NodeError::bus_refused;
  }

  // `none`, or what keeps this configuration from running: then step() does nothing.
  NodeError error() const noexcept { return error_; }
  // What the error is, where another room found it.
  law::FlashedAxisError axis_error() const noexcept { return axis_error_; }
  cia402::DriveConfigError drive_error() const noexcept { return drive_error_; }
  canopen::BusFit bus_fit() const noexcept { return bus_fit_; }

  // Once a period.
  void step(hal::Time now) noexcept {
    if (error_ != NodeError::none) return;
    if (const auto command = port_.take_command(0)) remote_.apply(loop_, *command);
    loop_.step(now);
    if (++periods_ % status_interval == 0)
      static_cast<void>(port_.send(status_frame(loop_, 0, config_.loop.node_id), now + config_.loop.period));
  }

 private:
  using Controller = law::AxisController<Scalar>;
  using Tap = CommandedPort<Port, 1>;
  using Loop = ControlLoop<Tap, cia402::Drive<Scalar>, Controller, Scalar, 1>;

  hal::AxisScale<Scalar> scale() const noexcept {
    return {config_.axis->parameters.encoder_resolution_m, config_.axis->parameters.max_force_N};
  }

  NodeError check() noexcept {
    if (config_.axis == nullptr) return NodeError::no_axis;
    axis_error_ = law::verify(*config_.axis);
    if (axis_error_ != law::FlashedAxisError::none) return NodeError::axis_refused;
    drive_error_ = cia402::check(config_.drive, config_.loop, scale());
    if (drive_error_ != cia402::DriveConfigError::none) return NodeError::drive_refused;
    const auto period_ns = static_cast<Scalar>(config_.loop.period.count());
    return same(config_.axis->parameters.period_s * Scalar(1e9), period_ns) ? NodeError::none
                                                                            : NodeError::period_differs;
  }

  // To the rounding of float.
  static bool same(Scalar a, Scalar b) noexcept { return std::abs(a - b) <= Scalar(1e-6) * std::abs(b); }

  NodeConfig<Scalar> config_;
  Tap port_;
  Loop loop_;
  RemoteAxis remote_;
  NodeError error_ = NodeError::none;
  law::FlashedAxisError axis_error_ = law::FlashedAxisError::none;
  cia402::DriveConfigError drive_error_ = cia402::DriveConfigError::none;
  canopen::BusFit bus_fit_ = canopen::BusFit::fits;
  std::uint32_t periods_ = 0;
};

}  // namespace breakaway::firmware
