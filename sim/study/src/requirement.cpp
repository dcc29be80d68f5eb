#include "breakaway/study/requirement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "breakaway/input/input_error.hpp"

namespace breakaway::study {
namespace {

struct Quantity {
  std::string_view name;
  double (*of)(const StudyRow&);
};

constexpr std::array quantities{
    Quantity{"worst_settling_s", [](const StudyRow& r) { return worst_settling_time_s(r); }},
    Quantity{"median_settling_s", [](const StudyRow& r) { return median_settling_time_s(r); }},
    Quantity{"worst_time_inside_s", [](const StudyRow& r) { return worst_time_inside_s(r); }},
    Quantity{"worst_error_m", [](const StudyRow& r) { return worst_error_m(r); }},
    Quantity{"overshoot_m", [](const StudyRow& r) { return worst_excursions(r).overshoot_m; }},
    Quantity{"beyond_m", [](const StudyRow& r) { return worst_excursions(r).beyond_m; }},
    Quantity{"peak_speed_m_s", [](const StudyRow& r) { return worst_excursions(r).peak_speed_m_s; }},
    Quantity{"peak_force_N", [](const StudyRow& r) { return largest_force_N(r); }},
    Quantity{"settled", [](const StudyRow& r) { return static_cast<double>(settled_runs(r)); }},
    Quantity{"limit_cycles", [](const StudyRow& r) { return static_cast<double>(limit_cycles(r)); }},
    Quantity{"faulted", [](const StudyRow& r) { return static_cast<double>(faulted_runs(r)); }},
};

std::string known_names() {
  std::string names;
  for (const Quantity& quantity : quantities) names += fmt::format("{}{}", names.empty() ? "" : ", ", quantity.name);
  return names;
}

// Who quotes a requirement for the shell may set spaces about its sign, as well as leave them out.
std::string_view without_spaces_around(std::string_view text) {
  const std::size_t first = std::min(text.find_first_not_of(' '), text.size());
  return text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

}  // namespace

bool Requirement::holds(const StudyRow& row) const {
  const double value = quantity(row);
  return at_least ? value >= bound : value <= bound;
}

Requirement read_requirement(std::string_view text) {
  const std::size_t sign = std::min(text.find("<="), text.find(">="));
  Requirement requirement{.text = std::string{text}};
  if (sign == text.npos)
    throw InputError{fmt::format("\"{}\" is no requirement: give one as worst_settling_s<=0.5", text)};
  const std::string_view name = without_spaces_around(text.substr(0, sign));
  const std::string_view number = without_spaces_around(text.substr(sign + 2));
  const auto known = std::ranges::find(quantities, name, &Quantity::name);
  if (known == quantities.end())
    throw InputError{fmt::format("\"{}\" is no quantity of a study; there are {}", name, known_names())};
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), requirement.bound);
  if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(requirement.bound))
    throw InputError{fmt::format("\"{}\": \"{}\" is not a finite number", text, number)};
  requirement.quantity = known->of;
  requirement.at_least = text[sign] == '>';
  return requirement;
}

std::vector<std::string> broken(const std::vector<Requirement>& requirements, const StudyRow& row) {
  std::vector<std::string> sentences;
  for (const Requirement& requirement : requirements) {
    if (requirement.holds(row)) continue;
    const double value = requirement.quantity(row);
    sentences.push_back(fmt::format("from {:g} m, {:g} m/s: {} is required, and it is {}", row.start.position_m,
                                    row.start.velocity_m_s, requirement.text,
                                    std::isinf(value) ? "never settled" : fmt::format("{:.4g}", value)));
  }
  return sentences;
}

}  // namespace breakaway::study
