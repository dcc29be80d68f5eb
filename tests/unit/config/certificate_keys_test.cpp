// Each key that a reader of axes knows is one that the certificate counts with, or passes over for a reason.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/certificate_keys.hpp"
#include "breakaway/config/read_node.hpp"
#include "certificate_scene.hpp"

namespace breakaway::config {
namespace {

std::string source(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream{BREAKAWAY_SOURCE_DIR "/" + file}.rdbuf();
  return text.str();
}

TEST(Certificate, KnowsEveryKeyThatAReaderOfAxesKnows) {
  std::string text;
  for (const char* file :
       {"firmware/config/src/axis_tables.cpp", "firmware/config/src/read_drive.cpp",
        "firmware/config/src/read_node.cpp", "firmware/config/src/read_told.cpp", "firmware/config/src/read_odrive.cpp",
        "firmware/config/src/sheet_rows.cpp", "firmware/config/src/wiring.cpp", "sim/scenario/src/read_scenario.cpp",
        "sim/scenario/src/read_quirks.cpp"})
    text += source(file);
  std::set<std::string, std::less<>> known;
  for (const CertificateKey& key : certificate_keys()) {
    known.emplace(key.key);
    EXPECT_NE(text.find(joined({"\"", key.key, "\""})), std::string::npos) << key.key << " is no key any more";
    EXPECT_EQ(key.standing == Standing::refused, !key.remedy.empty()) << key.key;
  }
  const std::regex row{R"re((?:optional|required|keep_table)\(\s*"(\w+)")re"};
  int rows = 0;
  for (std::sregex_iterator match{text.begin(), text.end(), row}, end; match != end; ++match, ++rows)
    EXPECT_TRUE(known.contains((*match)[1].str())) << (*match)[1] << ": say where the certificate stands to it";
  EXPECT_GE(rows, 60);
}

// Everything that is certified of an axis, or why nothing is.
std::string certificate(const std::string& text) {
  std::ostringstream out;
  out.precision(12);
  const std::string error = refusal([&] {
    const Node node = parse_node(text, "axis.toml");
    const design::DesignReport report = examine(node).front();
    for (const design::Check& check : report.checks) out << check.name << check.holds << check.margin << check.reason;
    for (const std::string& condition : report.conditions) out << condition;
    if (report.braked)
      out << report.braked->promise << report.braked->kick_peak_m_s << report.braked->hand_over_m
          << report.braked->least_move_s;
  });
  return error + out.str();
}

TEST(Certificate, ChangesWithEachKeyThatItCountsWith) {
  const std::pair<std::string, std::string> as_odrive{
      "rated_torque_Nm = 0.5\nmax_torque_per_mille = 2000",
      "protocol = \"odrive\"\ntravel_per_turn_m = 0.1\nmax_torque_Nm = 1"};
  const std::map<std::string, std::pair<std::string, std::string>> changes{
      {"plant.mass_kg", {"mass_kg = 1\n", "mass_kg = 1.1\n"}},
      {"friction.lower_N", {"lower_N = 2.5", "lower_N = 2.4"}},
      {"friction.upper_N", {"upper_N = 4.5", "upper_N = 4.6"}},
      {"friction.mu_lower", {"lower_N = 2.5\nupper_N = 4.5", "mu_lower = 0.2\nmu_upper = 0.4\ngravity_m_s2 = 9.81"}},
      {"friction.mu_upper", {"lower_N = 2.5\nupper_N = 4.5", "mu_lower = 0.25\nmu_upper = 0.5\ngravity_m_s2 = 9.81"}},
      {"friction.gravity_m_s2", {"lower_N = 2.5\nupper_N = 4.5", "mu_lower = 0.25\nmu_upper = 0.45\ngravity_m_s2 = 9"}},
      {"friction.smooth_slope_Ns_per_m", {"lower_N = 2.5", "lower_N = 2.5\nsmooth_slope_Ns_per_m = 1"}},
      {"friction.presliding_stiffness_N_per_m", {"lower_N = 2.5", "lower_N = 2.5\npresliding_stiffness_N_per_m = 1e7"}},
      {"controller.kind", {"k1_N_per_m = 400", "kind = \"pid\"\nk1_N_per_m = 400"}},
      {"controller.k1_N_per_m", {"k1_N_per_m = 400", "k1_N_per_m = 410"}},
      {"controller.k21_Ns_per_m", {"k21_Ns_per_m = 32", "k21_Ns_per_m = 31"}},
      {"controller.k22_Ns_per_m", {"k22_Ns_per_m = 60", "k22_Ns_per_m = 61"}},
      {"controller.kick", {"\"two_phase\"", "\"naive\""}},
      {"controller.coast", {"\"brake\"", "\"pd\""}},
      {"controller.feedforward_N", {"max_force_N = 48", "max_force_N = 48\nfeedforward_N = 1"}},
      {"controller.fine_stage", {"position_tolerance_m = 1e-6", "fine_stage = false\nposition_tolerance_m = 1e-6"}},
      {"controller.max_force_N", {"max_force_N = 48", "max_force_N = 45"}},
      {"controller.max_approach_speed_m_s", {"max_approach_speed_m_s = 5", "max_approach_speed_m_s = 0.5"}},
      {"controller.position_tolerance_m", {"position_tolerance_m = 5e-6", "position_tolerance_m = 6e-6"}},
      {"controller.target_m", {"target_m = 0", "target_m = 2"}},
      {"controller.targets", {"target_m = 0", "targets = [{ time_s = 1, position_m = 2 }]"}},
      {"drive.eds", {"rated_torque_Nm = 0.5", "eds = \"of_no_drive.eds\""}},
      {"drive.protocol", as_odrive},
      {"drive.travel_per_turn_m", as_odrive},
      {"drive.max_torque_Nm", as_odrive},
      {"drive.estimates", as_odrive},
      {"drive.rated_torque_Nm", {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.6"}},
      {"drive.max_torque_per_mille", {"max_torque_per_mille = 2000", "max_torque_per_mille = 1000"}},
      {"drive.force_per_torque_N_per_Nm", {"force_per_torque_N_per_Nm = 50", "force_per_torque_N_per_Nm = 55"}},
      {"drive.torque_relative_to", {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.5\ntorque_relative_to = \"max\""}},
      {"drive.peak_force_N", {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.5\npeak_force_N = 40"}},
      {"drive.encoder_resolution_m", {"resolution_m = 1e-6", "resolution_m = 2e-6"}},
      {"drive.current_loop_time_constant_s", {"constant_s = 1e-4", "constant_s = 2e-4"}},
      {"limits.position_m", {"target_m = 0\n[limits]\nposition_m = 1", "target_m = 0.9\n[limits]\nposition_m = 0.8"}},
      {"limits.position_min_m",
       {"target_m = 0\n[limits]\nposition_m = 1", "target_m = 0.9\n[limits]\nposition_min_m = 1"}},
      {"limits.position_max_m",
       {"target_m = 0\n[limits]\nposition_m = 1", "target_m = 0.9\n[limits]\nposition_max_m = 0.8"}},
      {"limits.speed_m_s", {"speed_m_s = 20", "speed_m_s = 1e-3"}},
      {"limits.force_N", {"force_N = 60", "force_N = 40"}},
      {"limits.following_error_m", {"following_error_m = 2", "following_error_m = 1e-6"}},
      {"told.mass_kg", {"[told]", "[told]\nmass_kg = 1.01"}},
      {"told.force_gain", {"[told]", "[told]\nforce_gain = 1.01"}},
      {"told.friction_lower_N", {"[told]", "[told]\nfriction_lower_N = 2.4"}},
      {"told.friction_upper_N", {"[told]", "[told]\nfriction_upper_N = 4.6"}},
      {"told.latency_periods", {"[told]", "[told]\nlatency_periods = 3"}},
      {"uncertainty.mass", {"mass = 0.02", "mass = 0.03"}},
      {"uncertainty.force_gain", {"force_gain = 0.02", "force_gain = 0.03"}},
      {"uncertainty.force_N", {"force_N = 0.3", "force_N = 0.4"}},
      {"uncertainty.current_loop_time_constant", {"constant = 0.2", "constant = 0.3"}},
      {"uncertainty.jitter_s", {"[uncertainty]", "[uncertainty]\njitter_s = 1e-5"}},
      {"uncertainty.encoder_noise_m", {"[uncertainty]", "[uncertainty]\nencoder_noise_m = 1e-6"}},
      {"move.distance_m", {"distance_m = 0.4", "distance_m = 0.3"}},
      {"move.speed_m_s", {"speed_m_s = 1\n", "speed_m_s = 0.9\n"}},
      {"move.acceleration_m_s2", {"acceleration_m_s2 = 20", "acceleration_m_s2 = 19"}},
      {"move.jerk_m_s3", {"jerk_m_s3 = 2000", "jerk_m_s3 = 1900"}},
      {"loop.period_s", {"period_s = 0.001", "period_s = 0.002"}},
      {"bus.bit_rate", {"1_000_000", "125_000"}},
      {"run.settle_tolerance_m", {"position_tolerance_m = 5e-6", "# none"}},
  };
  const std::string plain = certificate(scene);
  for (const CertificateKey& key : certificate_keys()) {
    if (key.standing != Standing::counted || key.table.empty() || key.table == "axis") continue;
    const std::string name = joined({key.table, ".", key.key});
    ASSERT_TRUE(changes.contains(name)) << name << ": say how the certificate changes with it";
    std::string text = scene;
    if (name == "run.settle_tolerance_m")
      text = with(text, "duration_s = 1", "settle_tolerance_m = 9e-6\nduration_s = 1");
    if (name == "controller.fine_stage")
      text = with(more("[run]", "settle_tolerance_m = 9e-6", text), "tolerance_m = 5e-6", "tolerance_m = 1e-6");
    const auto& [from, to] = changes.at(name);
    EXPECT_NE(certificate(with(text, from, to)), name == "controller.fine_stage" ? certificate(text) : plain) << name;
  }
}
}  // namespace
}  // namespace breakaway::config
