// What a ControlLoop asks of the law of an axis and of the drive that it commands.
#pragma once

#include <concepts>
#include <cstdint>

#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::firmware {

// clang-format off

// A controller of controller/law: position error in, force out.
template <class C, class Scalar>
concept AxisLaw = requires(C& controller, const C& constant, const law::Measurement<Scalar>& z, Scalar shift_m) {
  { controller.update(z) } noexcept -> std::same_as<law::ControlOutput<Scalar>>;
  { controller.shift_target(shift_m) } noexcept;
  { controller.reset() } noexcept;
  { controller.limit_force(shift_m) } noexcept;  // the actuator gives no more than this
  { constant.period_s() } noexcept -> std::same_as<Scalar>;  // for which it was designed
  { constant.encoder_resolution_m() } noexcept -> std::same_as<Scalar>;
  { constant.max_force_N() } noexcept -> std::same_as<Scalar>;
  { constant.fault() } noexcept -> std::same_as<law::ControlFault>;
  { constant.mode() } noexcept -> std::same_as<law::Mode>;
};

// The side of a protocol that concerns no single drive: canopen::Master says what the calls do.
template <class M>
concept BusMaster = std::constructible_from<M, const hal::NetworkConfig&> &&
    requires(M& master, const M& constant, const hal::CanFrame& in, hal::CanFrame& out, hal::Time now, std::uint8_t node,
             unsigned axes, const hal::NetworkConfig& network) {
  { M::node_of(in) } noexcept -> std::same_as<std::uint8_t>;
  { constant.is_own(in) } noexcept -> std::same_as<bool>;
  { M::is_command(in, node) } noexcept -> std::same_as<bool>;
  { M::sync_offset(axes, network) } noexcept -> std::same_as<hal::Duration>;
  { master.next_sync(out) } noexcept -> std::same_as<bool>;
  { master.next_heartbeat(out, now) } noexcept -> std::same_as<bool>;
};

// A drive on the bus: MotorDrive, and the frames that make it one. A drive that is asked for its samples has
// next_poll_frame(out) besides, which is called until it says false.
template <class D, class Scalar>
concept BusDrive = hal::MotorDrive<D, Scalar> && BusMaster<typename D::Master> &&
    std::constructible_from<D, const typename D::Config&, const hal::NetworkConfig&, const hal::AxisScale<Scalar>&> &&
    requires(D& drive, const D& constant, const hal::ReceivedFrame& in, hal::CanFrame& out, hal::Time now,
             std::int32_t count) {
  { drive.on_frame(in) } noexcept;
  { drive.on_sync(now) } noexcept;
  { drive.update(now) } noexcept;
  { drive.next_acyclic_frame(out, now) } noexcept -> std::same_as<bool>;
  { drive.next_command_frame(out) } noexcept -> std::same_as<bool>;
  { constant.node_id() } noexcept -> std::same_as<std::uint8_t>;  // gets the frames of this node
  { constant.encoder_resolution_m() } noexcept -> std::same_as<Scalar>;
  { constant.heartbeat_lost() } noexcept -> std::same_as<bool>;
  { constant.last_error_code() } noexcept -> std::same_as<std::uint16_t>;  // that it told of, of its own kind; 0: none
  { drive.take_emergency() } noexcept -> std::same_as<std::uint16_t>;  // the first that it told since the last call, or 0
  { constant.node_id_conflict() } noexcept -> std::same_as<bool>;
  { constant.reference_lost() } noexcept -> std::same_as<bool>;
  { drive.set_reference_counts(count) } noexcept;  // the axis stands at this count now
};

// clang-format on

}  // namespace breakaway::firmware
