#include "read_quirks.hpp"

#include <cstdint>
#include <vector>

namespace breakaway::scenario {

using namespace config;
using drive_emulator::HomeSwitches;

void read_quirks(const Section& section, drive_emulator::Quirks& q) {
  constexpr Range delay{0, 1};
  HomeSwitches switches;
  std::vector<Key> keys{
      optional("mode_display_delay_s", duration_s(q.mode_display_delay, delay)),
      optional("needs_mode_to_enable", boolean(q.needs_mode_to_enable)),
      optional("min_controlword_interval_s", duration_s(q.min_controlword_interval, delay)),
      optional("sync_alarm_periods",
               integer([&q](std::int64_t n) { q.sync_alarm_periods = static_cast<std::uint32_t>(n); }, 0, 1000)),
      optional("torque_relative_to_max", boolean(q.torque_relative_to_max)),
      optional("interpolation_in_ms_only", boolean(q.interpolation_in_ms_only)),
      optional("position_reversed", boolean(q.position_reversed)),
      optional(
          "position_range_counts",
          integer([&q](std::int64_t n) { q.position_range_counts = static_cast<std::uint32_t>(n); }, 0, 2147483647)),
      optional("feed_constant",
               integer([&q](std::int64_t n) { q.feed_constant = static_cast<std::uint32_t>(n); }, 0, 2147483647)),
      optional("sdo_response_delay_s", duration_s(q.sdo_response_delay, {0, 60})),
      optional("sdo_busy_s", duration_s(q.sdo_busy, {0, 60})),
      optional("homing_fails", boolean(q.homing_fails)),
      optional("homing_gives_up_after_s", duration_s(q.homing_gives_up_after, {0, 3600})),
      optional("low_limit_switch_m", number(switches.low_limit_m, "m", Range{})),
      optional("high_limit_switch_m", number(switches.high_limit_m, "m", Range{})),
      optional("home_switch_m", number(switches.home_m, "m", Range{})),
      optional("home_switch_width_m", number(switches.home_width_m, "m", positive)),
      optional("index_distance_m", number(switches.index_distance_m, "m", positive)),
      optional("speed_gain_Ns_per_m", number(switches.speed_gain_Ns_per_m, "N s/m", positive)),
      optional("refuses_start_with",
               integer([&q](std::int64_t n) { q.refuses_start_with = static_cast<std::uint16_t>(n); }, 0, 0xFFFF)),
      optional("informs_with",
               integer([&q](std::int64_t n) { q.informs_with = static_cast<std::uint16_t>(n); }, 0, 0xFFFF)),
      optional("informs_every_s", duration_s(q.informs_every, {1e-3, 3600})),
      optional("fixed_mapping", choice(q.fixed_mapping, {{"none", drive_emulator::FixedMapping::none},
                                                         {"fits", drive_emulator::FixedMapping::fits},
                                                         {"differs", drive_emulator::FixedMapping::differs}})),
      optional("refused_objects", numbers(q.refused_objects, "", {1, 65535})),
      optional("refusal_code",
               integer([&q](std::int64_t n) { q.refusal_code = static_cast<std::uint32_t>(n); }, 1, 0xFFFFFFFF)),
      optional("self_starting", boolean(q.self_starting)),
      optional("maps_in_pre_operational_only", boolean(q.maps_in_pre_operational_only)),
      optional("no_boot_up_message", boolean(q.no_boot_up_message)),
      optional("counts_from_power_on", boolean(q.counts_from_power_on)),
  };
  section.read(keys);
  for (const char* key : {"low_limit_switch_m", "high_limit_switch_m", "home_switch_m", "home_switch_width_m",
                          "index_distance_m", "speed_gain_Ns_per_m"}) {
    if (section.has(key)) q.switches = switches;
  }
}

}  // namespace breakaway::scenario
