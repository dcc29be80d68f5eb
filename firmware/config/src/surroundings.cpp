#include "surroundings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/certificate_keys.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/odrive/polled_timing.hpp"

namespace breakaway::config {
namespace {

using law::Coast;

constexpr double far_noise = 6;    // root mean squares that normally distributed noise is taken to stay within
constexpr double rounding = 1e-9;  // relative: a bound that is set to the very number holds it

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
  if (key == "tpdo_delay_max_s") to.feedback_delay_s = magnitude(section, key);
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

// Gathers sentences about one axis.
class Outside {
 public:
  Outside(const Node& node, const Axis& axis)
      : node_{node}, axis_{axis}, all_{axis.surroundings.uncertified}, gains_{*axis.controller.impulsive} {}

  std::vector<std::string> sentences() && {
    if (axis_.surroundings.gap_m > 0 && !by_work())
      add("[plant] backlash: a certificate of a rigid mechanism is of one without play; take coast = \"work\", "
          "simulate "
          "it, or leave the table out");
    if (axis_.surroundings.load)
      spring();
    else if (by_work())
      add("[controller] coast = \"work\" is for a load on a spring; give its [plant.load], or take \"brake\"");
    if (without_sync() && node_.loop) timing();
    forces();
    readings();
    presliding();
    if (axis_.surroundings.one_mass || axis_.surroundings.load) friction(), told();
    law();
    bus();
    return std::move(all_);
  }

 private:
  bool without_sync() const { return axis_.drive && axis_.drive->odrive; }
  // The certificate is for a class of axes: under any coast but pd.
  bool braked() const { return gains_.coast != Coast::pd; }
  bool by_work() const { return gains_.coast == Coast::work; }

  template <class... Values>
  void add(fmt::format_string<Values...> text, Values&&... values) {
    all_.push_back(fmt::format(text, std::forward<Values>(values)...));
  }

  void forces() {
    const Surroundings& s = axis_.surroundings;
    // Without a drive nothing bounds the force that ripples.
    const double ripple_N = s.ripple > 0 ? s.ripple * max_force_N(axis_) : 0;
    const double beside_N = left_N() + s.cogging_N + ripple_N;
    if (beside_N == 0) return;
    if (!braked())
      add("[plant] has {:.6g} N act beside the drive's force, of which the coast \"pd\" knows nothing; feed "
          "a constant force forward by feedforward_N, or take coast = \"brake\" with [uncertainty] force_N = {:.6g}",
          beside_N, beside_N);
    else if (beside_N > axis_.uncertainty.force_N * (1 + rounding))
      add("[plant] has {:.6g} N act beside the drive's force (what feedforward_N leaves of force_N, cogging, and the "
          "ripple of the greatest force), above [uncertainty] force_N = {:.6g}; raise that",
          beside_N, axis_.uncertainty.force_N);
  }

  odrive::PolledTiming polled_timing() const {
    hal::Duration heartbeat = node_.loop->period;
    for (const Axis& axis : node_.axes)
      if (axis.drive) heartbeat = std::min(heartbeat, axis.drive->heartbeat_period);
    const auto heartbeats = static_cast<unsigned>((node_.loop->period + heartbeat - hal::Duration{1}) / heartbeat);
    return odrive::polled_timing(static_cast<unsigned>(node_.axes.size()), *node_.bit_rate, heartbeats);
  }

  // Without a SYNC commands act and samples are taken when their frames have come.
  void timing() {
    const BusSurroundings& b = node_.bus_surroundings;
    const double off_s = hal::seconds(polled_timing().jitter()) + b.most_delay_s - b.least_delay_s;
    // Rounded up, so that what a sentence asks for is enough.
    const double jitter_s = std::ceil(off_s * 1e6 - rounding) * 1e-6;
    const std::string within = fmt::format(
        "[drive] protocol = \"odrive\" has no SYNC, so that commands and polled samples are up to {:g} s off whole "
        "periods, one against another",
        jitter_s);
    if (by_work())
      add("{}, and a certificate under the coast \"work\" takes in nothing of that; simulate it, or take protocol = "
          "\"canopen\"",
          within);
    else if (jitter_s > design::most_jitter * node_.period_s() * (1 + rounding))
      add("{}, and a certificate takes in half a period; take a [loop] period_s of at least {:g}, with estimates = "
          "\"polled\"",
          within, jitter_s / design::most_jitter);
    else if (axis_.drive->odrive->estimates == odrive::Estimates::cyclic)
      add("[drive] estimates = \"cyclic\" has the drive sample by a clock of its own, so that a sample is older by up "
          "to estimate_period_s one time than another, and a certificate takes in half a period of that; take "
          "estimates "
          "= \"polled\" under the coast \"brake\" with [uncertainty] jitter_s = {:g}, or simulate it",
          jitter_s);
    else if (!braked())
      add("{}, of which the coast \"pd\" knows nothing; take coast = \"brake\" with [uncertainty] jitter_s = {:g}",
          within, jitter_s);
    else if (off_s > axis_.uncertainty.jitter_s * (1 + rounding))
      add("{}, and [uncertainty] jitter_s = {:g} is less; raise that", within, axis_.uncertainty.jitter_s);
  }

  void readings() {
    const double rounding_m = without_sync() ? axis_.drive->odrive->rounding_m : 0;  // which the noise holds already
    const double off_m = axis_.surroundings.encoder_error_m, told_m = axis_.uncertainty.encoder_noise_m - rounding_m;
    if (off_m == 0 || (braked() && off_m <= told_m * (1 + rounding))) return;
    add("[plant] encoder_error: a reading may be {:.6g} m off beside its count (interpolation_m and 6 times noise_m), "
        "and [uncertainty] encoder_noise_m = {:.6g} is less; raise that, under coast = \"brake\"",
        off_m, told_m);
  }

  // The most that the feedforward leaves of the constant force, or is too much for it, whatever the force gain is.
  double left_N() const {
    const double given_N = feedforward_N(axis_), u = axis_.uncertainty.force_gain;
    const auto left = [&](double gain) {
      const double sum_N = axis_.surroundings.force_N + gain * given_N;
      return std::abs(sum_N) <= rounding * std::abs(given_N) ? 0 : std::abs(sum_N);
    };
    return std::max(left(1 - u), left(1 + u));
  }

  void friction() {
    const Surroundings& s = axis_.surroundings;
    const law::FrictionBounds<double> truth = friction_of_all(axis_), told = axis_.friction.bounds;
    const double least_N = truth.lower_N * (1 - s.drift), most_N = truth.upper_N * (1 + s.drift);
    if (least_N < told.lower_N * (1 - rounding) || most_N > told.upper_N * (1 + rounding))
      add("friction may be between {:.6g} and {:.6g} N, outside the {:.6g} to {:.6g} N that the controller is told; "
          "tell it [told] friction_lower_N and friction_upper_N that hold it",
          least_N, most_N, told.lower_N, told.upper_N);
    const double rise = s.rise_per_m_s > 0 ? s.rise_per_m_s * (truth.upper_N - truth.lower_N) * (1 + s.drift) : 0;
    if (!braked() && rise > axis_.friction.smooth_slope_Ns_per_m * (1 + rounding))
      add("[friction] law rises with speed, by {:.6g} N s/m at its steepest, and the approach under the coast \"pd\" "
          "may creep for ever where smooth_slope_Ns_per_m = {:.6g} is less; state it there, or take coast = \"brake\"",
          rise, axis_.friction.smooth_slope_Ns_per_m);
    if (braked() && axis_.friction.smooth_slope_Ns_per_m != 0)
      add("[friction] smooth_slope_Ns_per_m = {:.6g} is a force beside the dry friction, which the coast \"brake\" "
          "does not know; widen the bounds so that they hold it at the greatest speed, and leave it out",
          axis_.friction.smooth_slope_Ns_per_m);
  }

  void presliding() {
    const double stiffness = axis_.surroundings.bristles.stiffness_N_per_m;
    const double told = axis_.friction.presliding_stiffness_N_per_m;
    if (stiffness == 0) return;
    if (told == 0) {
      add("[plant] presliding: a certificate is of friction that holds the axis without a spring, and here it bends "
          "before it slides; state [friction] presliding_stiffness_N_per_m = {:.6g} under the coast \"brake\", "
          "simulate it, or leave the table out where the bending is far below a count",
          stiffness);
      return;
    }
    if (stiffness < told * (1 - rounding)) {
      const auto [true_text, told_text] = compared(stiffness, told);
      add("[plant] presliding: stiffness_N_per_m = {} is below [friction] presliding_stiffness_N_per_m = {}; lower "
          "that",
          true_text, told_text);
    }
    const double critical = 2 * std::sqrt(stiffness * truth_of(axis_).mass_kg);
    if (axis_.surroundings.bristles.damping_Ns_per_m > critical * (1 + rounding)) {
      const auto [damping_text, critical_text] = compared(axis_.surroundings.bristles.damping_Ns_per_m, critical);
      add("[plant] presliding: damping_Ns_per_m = {} is above 2 sqrt(stiffness mass) = {}, so that friction exceeds "
          "its bounds while it bends; simulate it, or lower that",
          damping_text, critical_text);
    }
  }

  // That `truth` is within what the controller is told; u: relative, either way.
  void within(std::string_view name, double told, double u, double truth) {
    const double share = braked() ? u : 0;
    if (truth >= told * (1 - share) * (1 - rounding) && truth <= told * (1 + share) * (1 + rounding)) return;
    add("[told] {} = {:.6g} is truly {:.6g}, {}; tell the truth, or take coast = \"brake\" with an [uncertainty] that "
        "holds it",
        name, told, truth,
        share > 0 ? fmt::format("beyond the [uncertainty] of {:g}", share)
                  : std::string{"and nothing allows for that"});
  }

  void told() {
    within("mass_kg", axis_.mass_kg, axis_.uncertainty.mass, mass_of_all_kg(axis_));
    if (!axis_.truth) return;
    if (axis_.drive)
      within("force_gain", 1, axis_.uncertainty.force_gain,
             axis_.truth->force_per_torque_N_per_Nm / axis_.drive->force_per_torque_N_per_Nm);
    if (axis_.latency_periods != 1)
      add("[told] latency_periods = {} is truly 1, and nothing allows for that; tell the truth", axis_.latency_periods);
  }

  void spring() {
    if (!braked())
      add("[plant] load: the coast \"pd\" is for one rigid mass, and here a load hangs on a spring; take coast = "
          "\"work\", or \"brake\" where the spring is stiff enough");
    if (!(axis_.surroundings.load->load_friction.lower_N > 0))
      add("[plant] load: without friction of its own it swings on for ever; state friction_lower_N, or simulate it");
  }

  void law() {
    const Uncertainty& u = axis_.uncertainty;
    const bool stated = u.mass > 0 || u.force_gain > 0 || u.force_N > 0 || u.current_loop_time_constant > 0 ||
                        u.jitter_s > 0 || u.encoder_noise_m > 0;
    if (!braked() && stated && !without_sync())
      add("[uncertainty] is stated, and the coast \"pd\" is certified for the very numbers of the file only; take "
          "coast = \"brake\"");
    if (gains_.kick == Kick::naive)
      add("[controller] kick = \"naive\" goes too far, and is there to compare with; take \"two_phase\"");
  }

  void bus() {
    const BusSurroundings& b = node_.bus_surroundings;
    if (b.loss_probability > 0)
      add("[bus] loss_probability = {:g} has commands lost, each of which makes a kick longer or shorter; a "
          "certificate needs 0",
          b.loss_probability);
    if (!without_sync()) delays();
    if (node_.loop && node_.bit_rate) answers();
  }

  void delays() {
    const BusSurroundings& b = node_.bus_surroundings;
    const double apart_s = b.most_delay_s - b.least_delay_s, jitter_s = axis_.uncertainty.jitter_s;
    if (apart_s > 0 && !braked())
      add("[bus] delay_max_s = {:g} is above delay_min_s, so that a kick may be longer or shorter than its periods; "
          "make them equal, or take coast = \"brake\" with [uncertainty] jitter_s = {:g}",
          b.most_delay_s, apart_s);
    else if (apart_s > jitter_s * (1 + rounding))
      add("[bus] delay_max_s = {:g} and delay_min_s are {:g} s apart, so that a kick may be as much longer or shorter "
          "than its periods, and [uncertainty] jitter_s = {:g} is less; raise that",
          b.most_delay_s, apart_s, jitter_s);
  }

  void answers() {
    const BusSurroundings& b = node_.bus_surroundings;
    if (without_sync()) {
      const double answered_s = hal::seconds(polled_timing().answered) + 2 * b.most_delay_s;
      if (axis_.drive->odrive->estimates == odrive::Estimates::polled && answered_s > node_.period_s())
        add("[loop] period_s = {:g} is over before every answer of a polled drive has come, after {:.6g} s; take a "
            "longer one",
            node_.period_s(), answered_s);
      return;
    }
    const auto needed_us =
        canopen::bus_budget(static_cast<unsigned>(node_.axes.size()), node_.loop->period, *node_.bit_rate).needed_us;
    const double round_s = 2 * b.least_delay_s + axis_.surroundings.feedback_delay_s;
    if (round_s > 0 && round_s + 1e-6 * needed_us > node_.period_s())
      add("[bus] and [drive] delay a reading by {:.6g} s beside the {} us of its frames, so that it comes too late for "
          "its period; lower delay_max_s or tpdo_delay_max_s, or take a longer period_s",
          round_s, needed_us);
  }

  const Node& node_;
  const Axis& axis_;
  std::vector<std::string> all_;
  const ImpulsiveGains& gains_;
};

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

std::vector<std::string> outside_class(const Node& node, const Axis& axis) { return Outside{node, axis}.sentences(); }

}  // namespace breakaway::config
