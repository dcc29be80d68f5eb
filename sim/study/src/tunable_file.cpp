#include "tunable_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "breakaway/config/axis_of_document.hpp"
#include "breakaway/config/edited_file.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::study {
namespace {

class Choices {
 public:
  Choices(const toml::table& document, const toml::table& axis) : document_{document}, axis_{axis} {}

  std::vector<config::Setting> settings() {
    choose_gains();
    choose_coast();
    if (sampled()) choose_tolerance();
    return settings_;
  }

 private:
  bool sampled() const { return document_.contains("loop"); }

  static std::optional<double> number(const toml::table& tables, std::string_view table, std::string_view key) {
    const auto value = tables[table][key].value<double>();
    return value && std::isfinite(*value) ? value : std::nullopt;
  }
  std::optional<double> number(std::string_view table, std::string_view key) const { return number(axis_, table, key); }

  void set(const char* table, const char* key, double value) {
    settings_.push_back({table, key, fmt::format("{}", value)});
  }

  // As of a new file: they must only damp less than critically in the approach, and more in the kicks.
  void choose_gains() {
    const double mass_kg = number("told", "mass_kg").value_or(number("plant", "mass_kg").value_or(1));
    const double k1 = number("controller", "k1_N_per_m").value_or(0);
    const double k21 = number("controller", "k21_Ns_per_m").value_or(0);
    const double k22 = number("controller", "k22_Ns_per_m").value_or(0);
    const double given = k1 > 0 ? 2 * std::sqrt(k1 * mass_kg) : 0;
    if (k21 > 0 && k21 < given && k22 > given) return;
    constexpr double omega = 20;  // 1/s
    const double critical = 2 * mass_kg * omega;
    set("controller", "k1_N_per_m", mass_kg * omega * omega);
    set("controller", "k21_Ns_per_m", 0.8 * critical);
    set("controller", "k22_Ns_per_m", 1.5 * critical);
  }

  // The brake bears with every other table, but it needs a drive and kicks of its own.
  void choose_coast() {
    const toml::table* const controller = axis_["controller"].as_table();
    if (controller == nullptr || !controller->contains("coast")) return;
    const bool possible = sampled() && axis_.contains("drive") && (*controller)["kick"].value<std::string>() != "naive";
    settings_.push_back({"controller", "coast", possible ? "\"brake\"" : "\"pd\""});
  }

  // Without one of the controller's own, that of the run counts.
  void choose_tolerance() {
    const double reading_m =
        number("drive", "encoder_resolution_m").value_or(0) / 2 + number("uncertainty", "encoder_noise_m").value_or(0);
    const double least_m = rounded_up(std::max(1.01 * reading_m, 1e-12), 3);
    const toml::table* const run = document_["run"].as_table();
    const bool settles = run != nullptr && run->contains("settle_tolerance_m");
    if (settles) {
      if (!(number(document_, "run", "settle_tolerance_m").value_or(0) > reading_m))
        set("run", "settle_tolerance_m", least_m);
      set("controller", "position_tolerance_m", 0);
    } else if (!(number("controller", "position_tolerance_m").value_or(0) > 0)) {
      set("controller", "position_tolerance_m", least_m);
    }
  }

  const toml::table &document_, &axis_;
  std::vector<config::Setting> settings_;
};

}  // namespace

std::string with_readable_choices(const std::string& text, const std::string& name, const std::string& axis) {
  return config::with_document(text, name, [&](const toml::table& document) {
    const toml::table* const tables = config::axis_of_document(document, axis);
    if (tables == nullptr || !tables->contains("controller")) return text;
    return config::with_settings(text, name, axis, Choices{document, *tables}.settings());
  });
}

}  // namespace breakaway::study
