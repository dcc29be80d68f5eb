#include "read_odrive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "axis_tables.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/odrive/messages.hpp"
#include "breakaway/odrive/turns_scale.hpp"
#include "read_drive.hpp"

namespace breakaway::config {
namespace {

// What of a file for CANopen has no meaning here.
std::vector<Key> of_canopen_alone() {
  return elsewhere(
      {"eds", "rated_torque_Nm", "rated_current_A", "max_torque_per_mille", "torque_relative_to", "position_unit",
       "sdo_timeout_s", "emcy_information", "home_method", "home_speed_m_s", "home_zero_speed_m_s",
       "home_acceleration_m_s2", "home_timeout_s", "tpdo_delay_min_s", "tpdo_delay_max_s", "seed", "quirks"},
      "it is for a drive of protocol = \"canopen\"; leave it out");
}

void check_estimates(const Section& section, const Odrive& o, const Node& node) {
  if (o.estimates == odrive::Estimates::polled) {
    if (section.has("estimate_period_s"))
      section.fail("estimate_period_s", "is for estimates = \"cyclic\"; leave out the one that is wrong");
    return;
  }
  if (o.estimate_period % std::chrono::milliseconds{1} != hal::Duration::zero())
    section.fail("estimate_period_s", "must be whole milliseconds, which is what a drive can be told; round it");
  if (node.loop && o.estimate_period > node.loop->period)
    section.fail("estimate_period_s",
                 fmt::format("is {:g}, above [loop] period_s = {:g}, so that a period may bring no sample; lower it, "
                             "or take estimates = \"polled\"",
                             hal::seconds(o.estimate_period), node.period_s()));
}

// The newest sample may be a period old, and two more where two in a row were lost. A drive that is silent for longer
// than heartbeat_timeout_s is set up anew, so that one with a shorter one would never be ready.
void check_timeout(const Section& section, const Drive& d, const Node& node) {
  if (!node.loop || d.heartbeat_timeout > 3 * node.loop->period) return;
  section.fail(
      "heartbeat_timeout_s",
      fmt::format("is {:g}, not above three periods of the loop, {:g}, after which a drive that lost two samples "
                  "shows the next; raise it, or take a shorter [loop] period_s",
                  hal::seconds(d.heartbeat_timeout), 3 * node.period_s()));
}

void check_drive_limits(const Section& section, const Odrive& o) {
  if (o.torque_constant_Nm_per_A.has_value() != o.velocity_limit_turns_s.has_value())
    section.fail(o.velocity_limit_turns_s ? "torque_constant_Nm_per_A" : "velocity_limit_turns_s",
                 "is missing: the drive is told its limits of velocity and current together; give both or none");
}

}  // namespace

std::vector<Key> odrive_keys_refused() {
  return elsewhere({"travel_per_turn_m", "max_torque_Nm", "torque_constant_Nm_per_A", "velocity_limit_turns_s",
                    "estimates", "estimate_period_s"},
                   "it is for a drive of protocol = \"odrive\"; set that, or leave it out");
}

Drive read_odrive(const Section& section, std::size_t place, const Node& node) {
  using cia402::Home;
  Drive d;
  Odrive o;
  Protocol protocol{};
  d.node_id = static_cast<std::uint8_t>(place + 1);
  section.read(std::vector<Key>{
                   required("protocol", choice(protocol, {{"odrive", Protocol::odrive}})),
                   optional("node_id", integer([&](std::int64_t n) { d.node_id = static_cast<std::uint8_t>(n); }, 0,
                                               odrive::most_node_id)),
                   required("travel_per_turn_m", number(o.travel_per_turn_m, "m", positive)),
                   required("max_torque_Nm", number(o.max_torque_Nm, "N m", {1e-3, 4e6})),
                   optional("torque_constant_Nm_per_A", number(o.torque_constant_Nm_per_A, "N m/A", positive)),
                   optional("velocity_limit_turns_s", number(o.velocity_limit_turns_s, "1/s", positive)),
                   optional("estimates", choice(o.estimates, {{"cyclic", odrive::Estimates::cyclic},
                                                              {"polled", odrive::Estimates::polled}})),
                   optional("estimate_period_s", duration_s(o.estimate_period, {1e-3, 1})),
                   optional("home", choice(d.homing.home, {{"none", Home::none}, {"here", Home::here}})),
                   optional("home_position_m", number(d.homing.position_m, "m", anywhere)),
               } +
               rows_of_any_drive(d) + of_canopen_alone());
  check_estimates(section, o, node);
  check_drive_limits(section, o);
  check_timeout(section, d, node);
  d.odrive = o;
  return d;
}

void take_in_spacing(const Section& drive, const std::optional<Section>& limits, Axis& axis) {
  if (!axis.drive || !axis.drive->odrive) return;
  const double travel_m = axis.drive->odrive->travel_per_turn_m, count_m = axis.drive->encoder_resolution_m;
  const double farthest_m = std::max(std::abs(axis.limits.position_min_m), std::abs(axis.limits.position_max_m));
  if (!std::isfinite(farthest_m))
    drive.fail("protocol",
               "is \"odrive\", which shows a position as a float that gets coarser with its distance from zero; give "
               "[limits] position_m, so that it is known how far the axis goes");
  const double spacing_m = odrive::float_spacing(farthest_m / travel_m) * travel_m;
  if (!odrive::TurnsScale{travel_m / count_m}.is_fine(farthest_m / travel_m))
    (limits ? *limits : drive)
        .fail(
            limits && limits->has("position_m") ? "position_m" : "position_max_m",
            fmt::format("lets the axis go to {:g} m, which are {:g} turns: there the drive's position, a float, comes "
                        "in steps of {:g} m, coarser than encoder_resolution_m = {:g}; narrow the range, or state "
                        "that coarser resolution",
                        farthest_m, farthest_m / travel_m, rounded_up(spacing_m, 3), count_m));
  axis.drive->odrive->rounding_m = spacing_m / 2;
  axis.uncertainty.encoder_noise_m += spacing_m / 2;
}

}  // namespace breakaway::config
