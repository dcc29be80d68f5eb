#include "surroundings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/certificate_keys.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::config {
namespace {

constexpr double far_noise = 6;  // root mean squares that normally distributed noise is taken to stay within

std::string place(std::string_view table, std::string_view key) {
  return table.empty() ? fmt::format("[{}]", key) : fmt::format("[{}] {}", table, key);
}

// A number that a certificate must know. Nothing else counts as no number: another reader refuses it.
double magnitude(const Section& section, std::string_view key) { return std::abs(section.number_at(key).value_or(0)); }
double nested_magnitude(const Section& section, std::string_view table, std::string_view key) {
  const auto inner = section.table_at(table);
  return inner ? magnitude(*inner, key) : 0;
}

// How steeply a friction law rises and falls with speed, at its steepest, where 1 is from bound to bound.
struct Slope {
  double rise_per_m_s = 0, fall_per_m_s = 0;
};

Slope slope_of(const Section& law);

Slope falls_over(double speed_m_s, double steepest) { return {0, speed_m_s > 0 ? steepest / speed_m_s : unlimited}; }

Slope of_static_kinetic(const Section& law) {
  const double at_rest = law.number_at("static_value").value_or(1),
               sliding = law.number_at("kinetic_value").value_or(0);
  return {sliding > at_rest ? unlimited : 0, sliding < at_rest ? unlimited : 0};
}

// Of what lies in [0, 1], a product is at most as steep as the sum.
Slope of_parts(const Section& law, bool greatest) {
  Slope all;
  for (const Section& part : law.tables_at("parts")) {
    const auto [rise, fall] = slope_of(part);
    all.rise_per_m_s = greatest ? std::max(all.rise_per_m_s, rise) : all.rise_per_m_s + rise;
    all.fall_per_m_s = greatest ? std::max(all.fall_per_m_s, fall) : all.fall_per_m_s + fall;
  }
  return all;
}

Slope of_mean(const Section& law) {
  const std::vector<Section> parts = law.tables_at("parts");
  std::vector<double> weights = law.numbers_at("weights");
  weights.resize(parts.size(), weights.empty() ? 1.0 : 0.0);
  Slope all;
  double sum = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (weights[i] == 0) continue;
    const auto [rise, fall] = slope_of(parts[i]);
    all.rise_per_m_s += weights[i] * rise;
    all.fall_per_m_s += weights[i] * fall;
    sum += weights[i];
  }
  return sum > 0 ? Slope{all.rise_per_m_s / sum, all.fall_per_m_s / sum} : Slope{};
}

// What this does not know may be as steep as it likes.
Slope slope_of(const Section& law) {
  const std::string_view kind = law.word("kind").value_or("");
  for (const std::string_view level :
       {"constant", "sine_in_time", "sine_in_position", "position_table", "random_dwell"})
    if (kind == level) return {};
  const double speed_m_s = magnitude(law, "velocity_m_s");
  if (kind == "stribeck") return falls_over(speed_m_s, 1);
  if (kind == "stribeck_gaussian") return falls_over(speed_m_s, std::numbers::sqrt2 * std::exp(-0.5));
  if (kind == "static_kinetic") return of_static_kinetic(law);
  if (kind == "mean") return of_mean(law);
  if (kind == "product") return of_parts(law, false);
  if (kind == "maximum" || kind == "minimum") return of_parts(law, true);
  if (const auto part = law.table_at("part"); kind == "complement" && part) {
    const auto [rise, fall] = slope_of(*part);
    return {fall, rise};
  }
  return {unlimited, unlimited};
}

// What the law and its certificate are made of is read to the letter.
design::SpringLoad read_load(const Section& section) {
  design::SpringLoad load;
  double seen_N_per_m = 0;
  auto& [lower_N, upper_N] = load.load_friction;
  section.read({
      required("mass_kg", number(load.load_kg, "kg", positive)),
      required("stiffness_N_per_m", number(load.stiffness_N_per_m, "N/m", spring)),
      optional("stiffness_seen_N_per_m", number(seen_N_per_m, "N/m", spring)),
      optional("damping_Ns_per_m", number(load.damping_Ns_per_m, "N s/m", damping)),
      optional("friction_lower_N", number(lower_N, "N", positive)),
      optional("friction_upper_N", number(upper_N, "N", positive)),
      optional("law", config::table([](const Section& /*of the simulation*/) {}, "law")),
      optional("encoder", choice(load.encoder_on_load, {{"motor", false}, {"load", true}})),
  });
  require_load_friction(section, lower_N, upper_N);
  if (seen_N_per_m > 0 && load.stiffness_N_per_m > seen_N_per_m)
    section.fail(
        "stiffness_N_per_m",
        fmt::format("is {:g} and exceeds stiffness_seen_N_per_m = {:g}, the least that the identification saw; "
                    "give a lower bound of that",
                    load.stiffness_N_per_m, seen_N_per_m));
  return load;
}

void look_at_bounded(const Section& section, std::string_view table, std::string_view key, Surroundings& to) {
  if (key == "force_N") to.force_N = section.number_at(key).value_or(0);
  if (key == "cogging") to.cogging_N = nested_magnitude(section, key, "amplitude_N");
  if (key == "ripple") to.ripple = nested_magnitude(section, key, "share");
  if (key == "presliding")
    section.read_alone(
        required(key, config::table([&](const Section& presliding) { to.bristles = read_presliding(presliding); })));
  if (key == "load")
    section.read_alone(required(key, config::table([&](const Section& load) { to.load = read_load(load); })));
  if (key == "backlash")
    section.read_alone(required(key, config::table([&](const Section& backlash) {
                                  backlash.read({required("gap_m", number(to.gap_m, "m", {0, 1}))});
                                })));
  if (key == "drift") to.drift = nested_magnitude(section, key, "share");
  if (key == "encoder_error")
    to.encoder_error_m =
        far_noise * nested_magnitude(section, key, "noise_m") + nested_magnitude(section, key, "interpolation_m");
  if (key == "tpdo_delay_max_s" || key == "tpdo_delay_min_s")
    to.feedback_delay_s = std::max(magnitude(section, "tpdo_delay_min_s"),
                                   std::abs(section.number_at("tpdo_delay_max_s").value_or(usual_feedback_delay_s)));
  if (const auto law = section.table_at(key); table == "friction" && law) to.rise_per_m_s = slope_of(*law).rise_per_m_s;
}

// The sentences of the keys that are refused, and of those that nobody has thought of.
void look_at_keys(const Section& section, std::string_view table, const std::function<void(std::string_view)>& bounded,
                  std::vector<std::string>& refused) {
  const auto rows = certificate_keys();
  for (const std::string_view key : section.keys()) {
    const auto row = std::ranges::find_if(
        rows, [&](const CertificateKey& known) { return known.table == table && known.key == key; });
    if (row == rows.end())
      refused.push_back(fmt::format("{}: no certificate takes it in; leave it out", place(table, key)));
    else if (row->standing == Standing::refused)
      refused.push_back(fmt::format("{}: {}", place(table, key), row->remedy));
    else if (row->standing == Standing::bounded)
      bounded(key);
  }
}

void look_at_node(const Section& section, std::string_view table, Node& node) {
  std::vector<std::string> refused;
  look_at_keys(
      section, table, [](std::string_view) {}, refused);
  for (Axis& axis : node.axes) {
    auto& all = axis.surroundings.uncertified;
    all.insert(all.end(), refused.begin(), refused.end());
  }
}

void look_at_bus(const Section& section, Node& node) {
  BusSurroundings& bus = node.bus_surroundings;
  bus.loss_probability = magnitude(section, "loss_probability");
  bus.least_delay_s = magnitude(section, "delay_min_s");
  bus.most_delay_s = std::max(bus.least_delay_s, magnitude(section, "delay_max_s"));
  look_at_node(section, "bus", node);
}

}  // namespace

Bristles read_presliding(const Section& presliding) {
  Bristles bristles;
  bool dahl = false;
  presliding.read({
      required("stiffness_N_per_m", number(bristles.stiffness_N_per_m, "N/m", spring)),
      optional("damping_Ns_per_m", number(bristles.damping_Ns_per_m, "N s/m", damping)),
      optional("model", choice(dahl, {{"lugre", false}, {"dahl", true}})),
  });
  if (dahl && bristles.damping_Ns_per_m != 0)
    presliding.fail("damping_Ns_per_m",
                    "stands beside model = \"dahl\", which has none; leave it out or take \"lugre\"");
  return bristles;
}

void require_load_friction(const Section& load, double lower_N, double upper_N) {
  const bool lower = lower_N > 0, upper = upper_N > 0;
  if (lower != upper || (!lower && load.has("law")))
    load.fail(lower ? "friction_upper_N" : "friction_lower_N", "is missing; give both bounds of the load's friction");
  if (lower_N > upper_N)
    load.fail("friction_lower_N",
              fmt::format("is {} and exceeds friction_upper_N = {}; swap or correct them", lower_N, upper_N));
}

void look_at(const Section& section, std::string_view table, Surroundings& to) {
  look_at_keys(
      section, table, [&](std::string_view key) { look_at_bounded(section, table, key, to); }, to.uncertified);
  if (section.has("load") || section.has("machine")) to.one_mass = false;
}

void look_at_root(const Section& root, Node& node) {
  look_at_node(root, "", node);
  for (const std::string_view table : {"loop", "run"})
    if (const auto section = root.table_at(table)) look_at_node(*section, table, node);
  if (const auto section = root.table_at("bus")) look_at_bus(*section, node);
}

}  // namespace breakaway::config
