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

// Of [friction], as forces or as coefficients, whichever the file has.
void enter_bounds(AxisEdits& edits, double lower_N, double upper_N, double mass_kg) {
  if (!edits.axis()["friction"]["mu_lower"]) {
    edits.set("friction", "lower_N", lower_N);
    edits.set("friction", "upper_N", upper_N);
    return;
  }
  const double weight_N = mass_kg * number_in(edits.axis(), "friction", "gravity_m_s2", 1);
  edits.set("friction", "mu_lower", rounded(lower_N / weight_N, std::floor, 5));
  edits.set("friction", "mu_upper", rounded(upper_N / weight_N, std::ceil, 5));
}

void enter_friction(AxisEdits& edits, const IdentifiedAxis& found, double mass_kg) {
  const bool told = edits.axis().contains("told");
  const double lower_N = rounded(found.friction_lower_N, std::floor);
  const double upper_N = rounded(found.friction_upper_N, std::ceil);
  if (!told) return enter_bounds(edits, lower_N, upper_N, mass_kg);
  edits.set("told", "friction_lower_N", lower_N);
  edits.set("told", "friction_upper_N", upper_N);
}

// The gains go with the mass.
void enter_gains(AxisEdits& edits, double mass_kg, double before_kg, double uncertainty) {
  for (const std::string_view gain : {"k1_N_per_m", "k21_Ns_per_m", "k22_Ns_per_m"})
    if (const auto value = edits.axis()["controller"][gain].value<double>())
      edits.set("controller", gain, with_digits(*value * mass_kg / before_kg, 6));
  edits.set("uncertainty", "mass", rounded(uncertainty, std::ceil, 2));
}

void enter_mass(AxisEdits& edits, double mass_kg, double uncertainty) {
  const toml::table& axis = edits.axis();
  const double before_kg = number_in(axis, "told", "mass_kg", number_in(axis, "plant", "mass_kg", mass_kg));
  edits.set(axis.contains("told") ? "told" : "plant", "mass_kg", mass_kg);
  enter_gains(edits, mass_kg, before_kg, uncertainty);
}

// Both sides, each for itself, and what the controller is told of both together.
void enter_spring(AxisEdits& edits, const IdentifiedSpring& spring, double uncertainty) {
  const double motor_kg = with_digits(spring.motor_kg, 5), load_kg = with_digits(spring.load_kg, 5);
  const auto plant = edits.axis()["plant"];
  const double both_kg = plant["mass_kg"].value_or(motor_kg) + plant["load"]["mass_kg"].value_or(load_kg);
  const double before_kg = number_in(edits.axis(), "told", "mass_kg", both_kg);
  const auto lower = [](double force_N) { return rounded(force_N, std::floor); };
  const auto upper = [](double force_N) { return rounded(force_N, std::ceil); };
  edits.set("plant", "mass_kg", motor_kg);
  enter_bounds(edits, lower(spring.motor_lower_N), upper(spring.motor_upper_N), motor_kg);
  edits.set("plant.load", "mass_kg", load_kg);
  edits.set("plant.load", "stiffness_N_per_m", rounded(spring.stiffness_N_per_m, std::floor, 3));
  edits.set("plant.load", "stiffness_seen_N_per_m", lower(spring.least_seen_N_per_m));
  edits.set("plant.load", "damping_Ns_per_m", rounded(spring.damping_Ns_per_m, std::floor, 2));
  edits.set("plant.load", "friction_lower_N", lower(spring.load_lower_N));
  edits.set("plant.load", "friction_upper_N", upper(spring.load_upper_N));
  edits.set("told", "mass_kg", with_digits(motor_kg + load_kg, 6));
  edits.set("told", "friction_lower_N", with_digits(lower(spring.motor_lower_N) + lower(spring.load_lower_N), 8));
  edits.set("told", "friction_upper_N", with_digits(upper(spring.motor_upper_N) + upper(spring.load_upper_N), 8));
  enter_gains(edits, motor_kg + load_kg, before_kg, uncertainty);
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
    if (found.spring) {
      enter_spring(edits, *found.spring, found.mass_uncertainty);
    } else {
      enter_friction(edits, found, mass_kg);
      enter_mass(edits, mass_kg, found.mass_uncertainty);
    }
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
