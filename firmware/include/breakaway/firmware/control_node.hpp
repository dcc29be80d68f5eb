// ControlNode: a whole controller on one bus, commanded by another node. A target's main() adds a port and a tick.
#pragma once

#include <cstddef>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/control_loop.hpp"
#include "breakaway/firmware/remote_control.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::firmware {

// What is flashed of one axis. The table must outlive the node.
template <class Scalar>
struct NodeConfig {
  LoopConfig loop{};
  cia402::DriveConfig<Scalar> drive{};
  law::AxisParameters<Scalar> parameters{};
  AxisLimits<Scalar> limits{};
  const law::K3Table<Scalar>* table = nullptr;
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
    const Controller controller{config.parameters, *config.table};
    setup_ = loop_.add_axis(cia402::Drive<Scalar>{config.drive}, controller, config.limits,
                            config.drive.encoder_resolution_m);
    if (setup_.ok()) setup_ = loop_.check_configuration();
  }

  // ok, or what keeps this configuration from running: then step() does nothing. invalid_argument with detail 100 and
  // the law::ParameterError added: the parameters of the law; 200: they contradict the drive's or the loop's.
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

  // Written as equalities of the very numbers: a header holds them twice, and twice the same.
  hal::Status check() const noexcept {
    const auto error = law::validate(config_.parameters);
    if (error != law::ParameterError::none)
      return {hal::StatusCode::invalid_argument, 100 + static_cast<std::uint32_t>(error)};
    const Scalar resolution_m = config_.drive.encoder_resolution_m;
    const bool one_encoder = !(resolution_m < config_.parameters.encoder_resolution_m) &&
                             !(resolution_m > config_.parameters.encoder_resolution_m);
    const bool one_limit = !(config_.drive.max_force_N < config_.parameters.max_force_N) &&
                           !(config_.drive.max_force_N > config_.parameters.max_force_N);
    const bool one_period = config_.loop.period == config_.drive.period;
    if (config_.table == nullptr || !one_encoder || !one_limit || !one_period)
      return {hal::StatusCode::invalid_argument, 200};
    return {};
  }

  NodeConfig<Scalar> config_;
  Tap port_;
  Loop loop_;
  RemoteAxis remote_;
  hal::Status setup_;
  std::uint32_t periods_ = 0;
};

}  // namespace breakaway::firmware
