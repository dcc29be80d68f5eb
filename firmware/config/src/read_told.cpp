#include "read_told.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>

namespace breakaway::config {
namespace {

constexpr int most_latency_periods = 8;

struct Told {
  std::optional<double> mass_kg, force_gain, lower_N, upper_N;
  std::optional<std::int64_t> latency_periods;
};

Told read_keys(const Section& section) {
  Told told;
  section.read({
      optional("mass_kg", number(told.mass_kg, "kg", positive)),
      optional("force_gain", number(told.force_gain, "", {1e-3, 1e3})),
      optional("friction_lower_N", number(told.lower_N, "N", positive)),
      optional("friction_upper_N", number(told.upper_N, "N", positive)),
      optional("latency_periods", integer([&](std::int64_t n) { told.latency_periods = n; }, 0, most_latency_periods)),
  });
  return told;
}

class Differences {
 public:
  void add(std::string_view name, double told, double truth) {
    if (told == truth) return;
    text_ += fmt::format("{}{} {:g} (truly {:g})", text_.empty() ? "" : ", ", name, told, truth);
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

void read_told(const Section& section, Axis& axis) {
  const Told told = read_keys(section);
  if (told.force_gain && !axis.drive)
    section.fail("force_gain", "needs a [drive]: without one there is no force to be mistaken of");
  axis.truth = truth_of(axis);
  axis.mass_kg = told.mass_kg.value_or(axis.mass_kg);
  law::FrictionBounds<double>& bounds = axis.friction.bounds;
  bounds = {told.lower_N.value_or(bounds.lower_N), told.upper_N.value_or(bounds.upper_N)};
  if (bounds.lower_N > bounds.upper_N)
    section.fail(
        told.lower_N ? "friction_lower_N" : "friction_upper_N",
        fmt::format("makes a lower bound of {:g} N above the upper one of {:g} N; correct the one or tell both",
                    bounds.lower_N, bounds.upper_N));
  if (axis.drive) axis.drive->force_per_torque_N_per_Nm *= told.force_gain.value_or(1);
  if (told.latency_periods) axis.latency_periods = static_cast<std::uint8_t>(*told.latency_periods);
}

std::string told_otherwise(const Axis& axis) {
  if (!axis.truth) return {};
  const Truth& truth = *axis.truth;
  Differences differences;
  differences.add("mass_kg", axis.mass_kg, truth.mass_kg);
  differences.add("force_gain", told_force_gain(axis), 1);
  differences.add("friction_lower_N", axis.friction.bounds.lower_N, truth.bounds.lower_N);
  differences.add("friction_upper_N", axis.friction.bounds.upper_N, truth.bounds.upper_N);
  differences.add("latency_periods", axis.latency_periods, 1);
  return std::move(differences).text();
}

}  // namespace breakaway::config
