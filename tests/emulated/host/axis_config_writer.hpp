// Writes the configuration that is flashed as a header.
#pragma once

#include <cmath>
#include <cstdio>
#include <fstream>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "axis_under_test.hpp"
#include "breakaway/firmware/control_node.hpp"

namespace breakaway::emulated {

// Of the scenario in float; the table must outlive it.
inline firmware::NodeConfig<float> node_config(const scenario::Scenario& s, const law::K3Table<float>& table) {
  const hal::Duration period = bench::period_of(s);
  return {.loop = {.period = period, .bit_rate = s.bus->bit_rate},
          .drive = bench::drive_config<float>(s, s.drive->node_id),
          .parameters = scenario::axis_parameters<float>(s),
          .limits = bench::limits<float>(s),
          .table = &table};
}

// Hexadecimal, and so exact.
inline std::string literal(float value) {
  if (std::isinf(value)) return value > 0 ? "INFINITY" : "-INFINITY";
  char text[40];
  std::snprintf(text, sizeof text, "%aF", static_cast<double>(value));
  return text;
}

inline std::string literals(std::initializer_list<float> values) {
  std::string text;
  for (const float value : values) text += (text.empty() ? "" : ", ") + literal(value);
  return text;
}

inline void write_axis_config(const std::string& path, const scenario::Scenario& s, const law::K3Table<float>& table) {
  const firmware::NodeConfig<float> c = node_config(s, table);
  const auto& p = c.parameters;
  std::ofstream file{path};
  file << "#pragma once\n#include <cmath>\n#include \"breakaway/firmware/control_node.hpp\"\nnamespace "
          "breakaway::config "
          "{\ninline constexpr law::K3Table<float> k3_table{"
       << literals({table.root_max, table.nodes_per_root}) << ", {{\n";
  for (const auto& node : table.nodes) file << "  {" << literals({node.value, node.slope}) << "},\n";
  file << "}}};\ninline constexpr law::AxisParameters<float> parameters{"
       << literals({p.mass_kg, p.stiffness_N_per_m, p.approach_damping_Ns_per_m, p.kick_damping_Ns_per_m,
                    p.friction_lower_N, p.friction_upper_N, p.max_force_N, p.max_approach_speed_m_s,
                    p.position_tolerance_m, p.encoder_resolution_m, p.period_s})
       << ", " << int{p.latency_periods}
       << "};\ninline constexpr firmware::NodeConfig<float> node{\n  .loop = {.period = "
       << "hal::Duration{" << c.loop.period.count() << "}, .bit_rate = " << c.loop.bit_rate
       << "},\n  .drive = {.node_id = " << int{c.drive.node_id}
       << ", .encoder_resolution_m = " << literal(c.drive.encoder_resolution_m)
       << ", .force_per_torque_N_per_Nm = " << literal(c.drive.force_per_torque_N_per_Nm)
       << ", .max_force_N = " << literal(c.drive.max_force_N) << ", .period = hal::Duration{" << c.drive.period.count()
       << "}},\n  .parameters = parameters,\n  .limits = {"
       << literals({c.limits.position_min_m, c.limits.position_max_m, c.limits.speed_m_s, c.limits.force_N,
                    c.limits.following_error_m})
       << ", hal::Duration{" << c.limits.feedback_timeout.count() << "}},\n  .table = &k3_table};\n}\n";
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace breakaway::emulated
