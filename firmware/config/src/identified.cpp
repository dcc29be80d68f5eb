#include "breakaway/config/identified.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "breakaway/config/axis_of_document.hpp"
#include "breakaway/config/edited_file.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

// To so many digits, away from what would promise more than was seen.
double rounded(double value, double (*to_whole)(double), int digits = 4) {
  if (!(value > 0)) return 0;
  const double unit = std::pow(10, std::floor(std::log10(value)) + 1 - digits);
  return std::stod(fmt::format("{:.{}e}", to_whole(value / unit) * unit, digits - 1));
}

// Settings that an axis gets; what was found is compared with what its tables say.
class AxisEdits {
 public:
  explicit AxisEdits(const toml::table& axis) : axis_{axis} {}

  // It holds [plant] and the rest.
  const toml::table& axis() const { return axis_; }
  const std::vector<Setting>& settings() const { return settings_; }

  void set(const std::string& table, std::string_view key, double value) {
    settings_.push_back({table, std::string{key}, fmt::format("{}", value)});
  }

 private:
  const toml::table& axis_;
  std::vector<Setting> settings_;
};

const toml::table& axis_in(const toml::table& document, const std::string& name, const std::string& file) {
  if (const toml::table* const axis = axis_of_document(document, name)) return *axis;
  throw InputError{"has no axis " + name}.in_file(file);
}

double number_in(const toml::table& axis, std::string_view table, std::string_view key, double otherwise) {
  return axis[table][key].value_or(otherwise);
}

double with_digits(double value, int digits) { return std::stod(fmt::format("{:.{}g}", value, digits)); }

void enter_friction(AxisEdits& edits, const IdentifiedAxis& found, double mass_kg) {
  const bool told = edits.axis().contains("told");
  const std::string table = told ? "told" : "friction", prefix = told ? "friction_" : "";
  const double lower_N = rounded(found.friction_lower_N, std::floor);
  const double upper_N = rounded(found.friction_upper_N, std::ceil);
  if (!told && edits.axis()["friction"]["mu_lower"]) {
    const double weight_N = mass_kg * number_in(edits.axis(), "friction", "gravity_m_s2", 1);
    edits.set(table, "mu_lower", rounded(lower_N / weight_N, std::floor, 5));
    edits.set(table, "mu_upper", rounded(upper_N / weight_N, std::ceil, 5));
    return;
  }
  edits.set(table, prefix + "lower_N", lower_N);
  edits.set(table, prefix + "upper_N", upper_N);
}

// The gains go with the mass.
void enter_mass(AxisEdits& edits, double mass_kg, double uncertainty) {
  const toml::table& axis = edits.axis();
  const double before_kg = number_in(axis, "told", "mass_kg", number_in(axis, "plant", "mass_kg", mass_kg));
  edits.set(axis.contains("told") ? "told" : "plant", "mass_kg", mass_kg);
  for (const std::string_view gain : {"k1_N_per_m", "k21_Ns_per_m", "k22_Ns_per_m"})
    if (const auto value = axis["controller"][gain].value<double>())
      edits.set("controller", gain, with_digits(*value * mass_kg / before_kg, 6));
  edits.set("uncertainty", "mass", rounded(uncertainty, std::ceil, 2));
}

void enter_lag(AxisEdits& edits, const IdentifiedAxis& found) {
  if (!found.lag_s) return;
  edits.set("drive", "current_loop_time_constant_s", with_digits(*found.lag_s, 3));
  const double known = number_in(edits.axis(), "uncertainty", "current_loop_time_constant", 0);
  edits.set("uncertainty", "current_loop_time_constant",
            std::max(known, rounded(std::min(found.lag_uncertainty, 0.9), std::ceil, 2)));
}

}  // namespace

std::string with_identified(std::string_view text, const std::string& file, const std::string& axis,
                            const IdentifiedAxis& found) {
  std::string edited = with_document(text, file, [&](const toml::table& document) {
    const toml::table& tables = axis_in(document, axis, file);
    AxisEdits edits{tables};
    const double mass_kg = with_digits(found.mass_kg, 5);
    enter_friction(edits, found, mass_kg);
    enter_mass(edits, mass_kg, found.mass_uncertainty);
    enter_lag(edits, found);
    if (found.presliding_stiffness_N_per_m)
      edits.set("friction", "presliding_stiffness_N_per_m",
                rounded(*found.presliding_stiffness_N_per_m, std::floor, 2));
    return "# Mass, friction, current loop and their uncertainties are from an experiment: `breakaway identify`.\n" +
           with_settings(text, file, tables["name"].value_or(std::string{}), edits.settings());
  });
  static_cast<void>(parse_node(edited, file + " with what was identified"));
  return edited;
}

}  // namespace breakaway::config
