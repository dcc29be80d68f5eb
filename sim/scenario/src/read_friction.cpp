#include "read_friction.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>
#include <vector>

#include "breakaway/model/shapes.hpp"

namespace breakaway::scenario {

using namespace config;
namespace {

using model::ShapePtr;

constexpr Range share{0, 1};
// Friction that changes faster than this means nothing to a mass, and a run would take for ever to follow it.
constexpr Range frequency{0, 1e5, true};
constexpr Range wavelength{1e-5, 1e12};
constexpr Range dwell{1e-5, 1e12};

// Reads the keys that one kind has, beside the key `kind` itself, which is read.
void read_keys(const Section& section, std::vector<Key> keys) {
  bool is_that = true;
  keys.push_back(required("kind", choice(is_that, {{section.word("kind").value_or(""), true}})));
  section.read(keys);
}

Value shapes(std::vector<ShapePtr>& to) {
  return tables([&to](const Section& part) { to.push_back(read_shape(part)); }, "law");
}

ShapePtr read_constant(const Section& section) {
  double value = 1;
  read_keys(section, {optional("value", number(value, "", share))});
  return model::shape::constant(value);
}

ShapePtr read_static_kinetic(const Section& section) {
  double at_rest = 1, sliding = 0;
  read_keys(section, {optional("static_value", number(at_rest, "", share)),
                      optional("kinetic_value", number(sliding, "", share))});
  return model::shape::static_kinetic(at_rest, sliding);
}

double read_stribeck_velocity(const Section& section) {
  double velocity_m_s = 0;
  read_keys(section, {required("velocity_m_s", number(velocity_m_s, "m/s", positive))});
  return velocity_m_s;
}

ShapePtr read_sine_in_time(const Section& section) {
  double frequency_rad_s = 0, phase_rad = 0;
  read_keys(section, {required("angular_frequency_rad_s", number(frequency_rad_s, "rad/s", frequency)),
                      optional("phase_rad", number(phase_rad, "rad"))});
  return model::shape::sine_in_time(frequency_rad_s, phase_rad);
}

ShapePtr read_sine_in_position(const Section& section) {
  double period_m = 0, phase_rad = 0;
  read_keys(section,
            {required("period_m", number(period_m, "m", wavelength)), optional("phase_rad", number(phase_rad, "rad"))});
  return model::shape::sine_in_position(period_m, phase_rad);
}

ShapePtr read_position_table(const Section& section) {
  std::vector<double> edges_m, values;
  read_keys(section, {required("edges_m", numbers(edges_m, "m")), required("values", numbers(values, "", share))});
  return model::shape::position_table(std::move(edges_m), std::move(values));
}

ShapePtr read_random_dwell(const Section& section) {
  model::shape::RandomDwell p;
  read_keys(section,
            {optional("seed", integer([&](std::int64_t n) { p.seed = static_cast<std::uint64_t>(n); }, 0, INT64_MAX)),
             optional("shortest_dwell_s", number(p.shortest_dwell_s, "s", dwell)),
             optional("longest_dwell_s", number(p.longest_dwell_s, "s", dwell)),
             optional("bound_share", number(p.bound_share, "", share))});
  return model::shape::random_dwell(p);
}

ShapePtr read_mean(const Section& section) {
  std::vector<double> weights;
  std::vector<ShapePtr> parts;
  read_keys(section, {optional("weights", numbers(weights, "", {0, 1e12})), required("parts", shapes(parts))});
  if (weights.empty()) weights.assign(parts.size(), 1.0);
  return model::shape::mean(std::move(weights), std::move(parts));
}

std::vector<ShapePtr> read_parts(const Section& section) {
  std::vector<ShapePtr> parts;
  read_keys(section, {required("parts", shapes(parts))});
  return parts;
}

ShapePtr read_complement(const Section& section) {
  ShapePtr part;
  read_keys(section, {required("part", shape_value(part))});
  return model::shape::complement(std::move(part));
}

struct Kind {
  std::string_view name;
  ShapePtr (*read)(const Section&);
};

constexpr std::array kinds{
    Kind{"constant", read_constant},
    Kind{"static_kinetic", read_static_kinetic},
    Kind{"stribeck", [](const Section& s) { return model::shape::stribeck(read_stribeck_velocity(s)); }},
    Kind{"stribeck_gaussian",
         [](const Section& s) { return model::shape::stribeck_gaussian(read_stribeck_velocity(s)); }},
    Kind{"sine_in_time", read_sine_in_time},
    Kind{"sine_in_position", read_sine_in_position},
    Kind{"position_table", read_position_table},
    Kind{"random_dwell", read_random_dwell},
    Kind{"mean", read_mean},
    Kind{"product", [](const Section& s) { return model::shape::product(read_parts(s)); }},
    Kind{"maximum", [](const Section& s) { return model::shape::maximum(read_parts(s)); }},
    Kind{"minimum", [](const Section& s) { return model::shape::minimum(read_parts(s)); }},
    Kind{"complement", read_complement},
};

void require_ordered(const Section& section, std::string_view lower, double low, std::string_view upper, double up) {
  if (low <= up) return;
  section.fail(lower, fmt::format("is {} and exceeds {} = {}; swap or correct them", low, upper, up));
}

}  // namespace

ShapePtr read_shape(const Section& section) {
  const Kind* known = nullptr;
  std::vector<std::pair<std::string_view, const Kind*>> names;
  names.reserve(std::size(kinds));
  for (const Kind& kind : kinds) names.emplace_back(kind.name, &kind);
  section.read_alone(required("kind", choice(known, std::move(names))));
  try {
    return known->read(section);
  } catch (const InputError& error) {
    if (!error.file().empty()) throw;  // it names its place already
    section.fail("kind", fmt::format("= \"{}\": {}", known->name, error.what()));
  }
}

Value shape_value(ShapePtr& to) {
  return table([&to](const Section& law) { to = read_shape(law); }, "law");
}

model::FrictionLaw read_friction_law(const Section& section) {
  double lower_N = 0, upper_N = 0;
  ShapePtr shape = model::shape::constant(1);
  section.read({required("lower_N", number(lower_N, "N", positive)),
                required("upper_N", number(upper_N, "N", positive)), optional("law", shape_value(shape))});
  require_ordered(section, "lower_N", lower_N, "upper_N", upper_N);
  return {{lower_N, upper_N}, std::move(shape)};
}

}  // namespace breakaway::scenario
