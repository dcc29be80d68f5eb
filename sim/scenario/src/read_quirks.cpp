#include "read_quirks.hpp"

#include <cstdint>
#include <vector>

namespace breakaway::scenario {

using namespace config;

void read_quirks(const Section& section, drive_emulator::Quirks& q) {
  constexpr Range delay{0, 1};
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
      optional("refuses_start_with",
               integer([&q](std::int64_t n) { q.refuses_start_with = static_cast<std::uint16_t>(n); }, 0, 0xFFFF)),
      optional("self_starting", boolean(q.self_starting)),
      optional("maps_in_pre_operational_only", boolean(q.maps_in_pre_operational_only)),
      optional("no_boot_up_message", boolean(q.no_boot_up_message)),
      optional("counts_from_power_on", boolean(q.counts_from_power_on)),
  };
  section.read(keys);
}

}  // namespace breakaway::scenario
