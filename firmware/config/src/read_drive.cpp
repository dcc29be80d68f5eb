#include "read_drive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "axis_tables.hpp"
#include "emcy_codes.hpp"
#include "read_odrive.hpp"
#include "sheet_rows.hpp"

namespace breakaway::config {
namespace {

Value thousandths(std::uint32_t& to, std::string_view unit) {
  return number([&to](double value) { to = static_cast<std::uint32_t>(std::lround(value * 1000)); }, unit, {1e-3, 4e6});
}

std::vector<Key> homing_rows(Homing& homing) {
  using cia402::Home;
  return {
      optional("home", choice(homing.home, {{"none", Home::none}, {"here", Home::here}, {"drive", Home::by_drive}})),
      optional("home_position_m", number(homing.position_m, "m", anywhere)),
      optional("home_method", integer([&](std::int64_t n) { homing.method = static_cast<std::int8_t>(n); }, -128, 127)),
      optional("home_speed_m_s", number(homing.speed_m_s, "m/s", positive)),
      optional("home_zero_speed_m_s", number(homing.zero_speed_m_s, "m/s", positive)),
      optional("home_acceleration_m_s2", number(homing.acceleration_m_s2, "m/s^2", positive)),
      optional("home_timeout_s", duration_s(homing.timeout, {1e-1, 3600})),
  };
}

// What is said of a home that nobody looks for is a mistake.
void check_homing(const Section& section, const Drive& d) {
  using cia402::Home;
  const Homing& homing = d.homing;
  if (homing.home != Home::none && d.absolute_encoder)
    section.fail("home", "stands beside encoder = \"absolute\", which needs none; leave out the one that is wrong");
  for (const char* key :
       {"home_method", "home_speed_m_s", "home_zero_speed_m_s", "home_acceleration_m_s2", "home_timeout_s"}) {
    if (section.has(key) && homing.home != Home::by_drive)
      section.fail(key, "is for a drive that finds its home by itself; set home = \"drive\", or leave it out");
  }
  if (section.has("home_position_m") && homing.home == Home::none)
    section.fail("home_position_m", "needs a home; set home = \"here\" or \"drive\", or leave it out");
  const double most = std::numeric_limits<std::int32_t>::max() * d.encoder_resolution_m;
  if (std::abs(homing.position_m) > most)
    section.fail("home_position_m", fmt::format("is beyond the {:g} m that a drive can count; lower it", most));
  for (const auto& [key, rate] :
       {std::pair{"home_speed_m_s", homing.speed_m_s}, std::pair{"home_zero_speed_m_s", homing.zero_speed_m_s},
        std::pair{"home_acceleration_m_s2", homing.acceleration_m_s2}}) {
    if (rate && *rate > most)
      section.fail(key, fmt::format("is beyond what a drive can be told in counts, {:g}; lower it", most));
  }
}

Drive read_canopen_drive(const Section& section, std::size_t place, std::vector<Key> others) {
  Drive d;
  Protocol protocol{};
  d.node_id = static_cast<std::uint8_t>(place + 1);
  section.read(
      std::vector<Key>{
          optional("protocol", choice(protocol, {{"canopen", Protocol::canopen}})),
          optional("node_id", integer([&](std::int64_t n) { d.node_id = static_cast<std::uint8_t>(n); }, 1, 127)),
          sheet_row(d),
          optional("rated_torque_Nm", thousandths(d.rated_torque_mNm, "N m")),
          optional("rated_current_A", thousandths(d.rated_current_mA, "A")),
          optional("max_torque_per_mille",
                   integer([&](std::int64_t n) { d.max_torque_per_mille = static_cast<std::uint16_t>(n); }, 1, 32767)),
          optional("torque_relative_to",
                   choice(d.torque_base, {{"rated", cia402::TorqueBase::rated}, {"max", cia402::TorqueBase::largest}})),
          optional("position_unit", choice(d.user_position_unit, {{"encoder", false}, {"user", true}})),
          optional("sdo_timeout_s", duration_s(d.sdo_timeout, {1e-3, 60})),
          optional("emcy_information", emcy_codes(d.emcy_information)),
      } +
      rows_of_any_drive(d) + homing_rows(d.homing) + odrive_keys_refused() + std::move(others));
  take_from_sheet(section, d);
  return d;
}

}  // namespace

std::vector<Key> rows_of_any_drive(Drive& d) {
  return {
      required("force_per_torque_N_per_Nm", number(d.force_per_torque_N_per_Nm, "N/(N m)", positive)),
      optional("peak_force_N", number(d.peak_force_N, "N", positive)),
      required("encoder_resolution_m", number(d.encoder_resolution_m, "m", {1e-12, 1})),
      optional("current_loop_time_constant_s", number(d.current_loop_time_constant_s, "s", up_to_a_second)),
      optional("invert_direction", boolean(d.invert_direction)),
      optional("encoder", choice(d.absolute_encoder, {{"incremental", false}, {"absolute", true}})),
      optional("heartbeat_period_s", duration_s(d.heartbeat_period, heartbeat)),
      optional("heartbeat_timeout_s", duration_s(d.heartbeat_timeout, heartbeat_timeout)),
  };
}

Drive read_drive(const Section& section, std::size_t place, const Node& node, std::vector<Key> others) {
  Protocol protocol = Protocol::canopen;
  section.read_alone(
      optional("protocol", choice(protocol, {{"canopen", Protocol::canopen}, {"odrive", Protocol::odrive}})));
  Drive d = protocol == Protocol::odrive ? read_odrive(section, place, node)
                                         : read_canopen_drive(section, place, std::move(others));
  // The simulation takes steps of a fraction of it, so a run would take for ever.
  if (d.current_loop_time_constant_s > 0 && d.current_loop_time_constant_s < 1e-8)
    section.fail("current_loop_time_constant_s", "is below 1e-8; give 0 for a current loop without lag");
  check_homing(section, d);
  if (d.heartbeat_timeout <= d.heartbeat_period)
    section.fail("heartbeat_timeout_s", "is not above heartbeat_period_s; raise it to two or three periods");
  return d;
}

void check_in_node(const Section& section, const Drive& drive, const Node& node) {
  const unsigned id = drive.node_id;
  if (node.loop && id == node.loop->node_id && !drive.odrive)
    section.fail("node_id", fmt::format("is {}, as that of the [loop]; change one of them", id));
  for (const Axis& other : node.axes) {
    if (other.drive && other.drive->protocol() != drive.protocol())
      section.fail("protocol", fmt::format("differs from that of axis {}; a bus speaks one protocol", other.name));
    if (other.drive && other.drive->node_id == drive.node_id)
      section.fail("node_id", fmt::format("is {}, as that of axis {}; give every drive its own", id, other.name));
  }
  if (!node.loop || drive.odrive) return;
  // Drive and node watch each other with one timeout. The node's heartbeats leave with its periods.
  const Loop& loop = *node.loop;
  const auto periods = (loop.heartbeat_period + loop.period - hal::Duration{1}) / loop.period;
  if (drive.heartbeat_timeout <= periods * loop.period)
    section.fail("heartbeat_timeout_s",
                 fmt::format("is {}, not above the [loop] heartbeat_period_s = {} in whole periods; raise the one or "
                             "lower the other",
                             hal::seconds(drive.heartbeat_timeout), hal::seconds(loop.heartbeat_period)));
}

}  // namespace breakaway::config
