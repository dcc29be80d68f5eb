#include "synthesis_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string_view>

#include "breakaway/format/json_writer.hpp"
#include "breakaway/report/conditions_json.hpp"

namespace breakaway::cli {
namespace {

using Eigen::MatrixXd;

std::string matrix_text(const MatrixXd& matrix) {
  std::vector<std::string> rows;
  for (const auto& line : matrix.rowwise())
    rows.push_back(fmt::format("[{:.6g}]", fmt::join(std::vector<double>(line.begin(), line.end()), ", ")));
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

void write_matrix(format::JsonWriter& json, std::string_view name, const MatrixXd& matrix) {
  json.array(name, [&] {
    for (const auto& line : matrix.rowwise()) {
      json.array([&] {
        for (const double entry : line) json.value(entry);
      });
    }
  });
}

void write_sweep(format::JsonWriter& json, const std::vector<stability::GainSweepRow>& rows) {
  json.array("sweep", [&] {
    for (const auto& row : rows) {
      json.object([&] {
        json.member("d1", row.velocity_gain_Ns_per_m);
        json.member("rho_star_J", row.rho_star_J);
        json.member("global", std::isinf(row.rho_star_J));
        json.member("E_certified", row.E_certified);
      });
    }
  });
}

}  // namespace

std::string to_json(const Synthesis& s) {
  format::JsonWriter json;
  json.object([&] {
    json.member("title", s.closed_loop.title);
    json.member("structure", s.structure);
    write_matrix(json, "actuators", s.system.actuators);
    write_matrix(json, "position_gain", s.design.gains.position_N_per_m);
    write_matrix(json, "velocity_gain", s.design.gains.velocity_Ns_per_m);
    json.member("resting_error_m", s.design.extent_m.maxCoeff());
    json.member("rho_star_J", s.design.attractivity.rho_star_J);
    json.member("global", std::isinf(s.design.attractivity.rho_star_J));
    json.member("reach_m", s.design.reach_m);
    json.member("E_certified", s.design.attractivity.all_of_E);
    report::write_conditions(json, s.conditions);
    json.object("theorem_2", [&] {
      write_matrix(json, "A", s.theorem_2.A);
      write_matrix(json, "Y", s.theorem_2.Y);
      json.member("least_eigenvalue_of_minus_A", s.theorem_2.hurwitz);
      json.member("lmi_margin", s.theorem_2.lmi);
    });
    write_sweep(json, s.sweep);
    json.object("simulation", [&] {
      json.member("trajectories", s.batch.trajectories);
      json.member("at_rest", s.batch.at_rest);
      json.member("on_their_way", s.batch.on_their_way);
      json.member("refused", s.batch.refused);
      json.member("seed", s.seed);
      json.member("level_J", s.simulated_level_J);
      json.member("duration_s", s.simulated_for_s);
    });
  });
  return json.text();
}

void print_summary(const Synthesis& s) {
  const auto& a = s.design.attractivity;
  if (!s.closed_loop.title.empty()) fmt::print("{}\n", s.closed_loop.title);
  fmt::print("  position gain  {} N/m\n", matrix_text(s.design.gains.position_N_per_m));
  fmt::print("  velocity gain  {} N s/m\n", matrix_text(s.design.gains.velocity_Ns_per_m));
  fmt::print("  resting error  {:.6g} m\n", s.design.extent_m.maxCoeff());
  if (std::isinf(a.rho_star_J)) {
    fmt::print("  region         everywhere\n");
  } else {
    fmt::print("  region         V < {:.6g} J, every rest within {:.6g} m\n", a.rho_star_J, s.design.reach_m);
  }
  for (const auto& row : s.sweep) {
    const std::string level =
        std::isinf(row.rho_star_J) ? std::string{"infinite"} : fmt::format("{:.6g} J", row.rho_star_J);
    fmt::print("  d1 = {:<9.6g} rho* = {}{}\n", row.velocity_gain_Ns_per_m, level,
               row.E_certified ? "" : ", not all of E");
  }
  fmt::print("  simulated      {} of {} starts with V < {:.6g} J came to rest (seed {})\n", s.batch.at_rest,
             s.batch.trajectories, s.simulated_level_J, s.seed);
  if (s.batch.on_their_way > 0) {
    fmt::print("  on their way   {} of them, with less energy than at first, when {:.6g} s were over\n",
               s.batch.on_their_way, s.simulated_for_s);
  }
  if (s.batch.refused > 0) fmt::print("  refused        {} of them, by the integrator\n", s.batch.refused);
  if (s.batch.not_at_rest) {
    fmt::print("  COUNTER-EXAMPLE from q = {}, v = {}\n", matrix_text(s.batch.not_at_rest->q.transpose()),
               matrix_text(s.batch.not_at_rest->v.transpose()));
  }
}

}  // namespace breakaway::cli
