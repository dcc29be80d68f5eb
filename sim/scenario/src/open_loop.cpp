#include "breakaway/scenario/open_loop.hpp"

#include <sstream>
#include <utility>

#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/parse_toml.hpp"

namespace breakaway::scenario {

using namespace config;
namespace {

// Of a file that parse_machine_scenario has accepted.
toml::table without_gains(std::string_view text, const std::string& name) {
  toml::table document = parse_toml(text, name);
  if (toml::table* feedback = document["feedback"].as_table()) {
    feedback->erase("position_gain");
    feedback->erase("velocity_gain");
  }
  return document;
}

std::string text_of(const toml::table& document) {
  std::ostringstream text;
  text << toml::toml_formatter{document} << '\n';
  return text.str();
}

Eigen::MatrixXd actuators(const toml::table& document, Eigen::Index coordinates) {
  const auto rows = document["feedback"]["actuators"];
  const toml::array* first = rows[0].as_array();
  if (first == nullptr) return Eigen::MatrixXd::Identity(coordinates, coordinates);
  return Eigen::MatrixXd::NullaryExpr(coordinates, static_cast<Eigen::Index>(first->size()), [&](auto i, auto j) {
    return rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].value_or(0.0);
  });
}

toml::array to_toml(const Eigen::MatrixXd& matrix) {
  toml::array rows;
  for (const auto& line : matrix.rowwise()) {
    toml::array row;
    for (const double entry : line) row.push_back(entry);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

OpenLoop parse_open_loop(std::string_view text, const std::string& name) {
  static_cast<void>(parse_machine_scenario(text, name));
  const toml::table document = without_gains(text, name);
  OpenLoop open{parse_machine_scenario(text_of(document), name), {}, std::string{text}};
  open.actuators = actuators(document, open.scenario.machine.coordinates());
  return open;
}

OpenLoop read_open_loop(const std::filesystem::path& file) {
  return parse_open_loop(file_contents(file), shown_name(file));
}

std::string with_gains(const OpenLoop& open, const Eigen::MatrixXd& position_gain_N_per_m,
                       const Eigen::MatrixXd& velocity_gain_Ns_per_m) {
  toml::table document = parse_toml(open.text, open.scenario.file);
  if (!document.contains("feedback")) document.insert("feedback", toml::table{});
  toml::table& feedback = *document["feedback"].as_table();
  feedback.insert_or_assign("position_gain", to_toml(position_gain_N_per_m));
  feedback.insert_or_assign("velocity_gain", to_toml(velocity_gain_Ns_per_m));
  return text_of(document);
}

}  // namespace breakaway::scenario
