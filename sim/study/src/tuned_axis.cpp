#include "tuned_axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "tunable_file.hpp"

namespace breakaway::study {
namespace {

Gains gains_of(const config::Node& node, const config::Axis& axis) {
  const config::ImpulsiveGains& g = *axis.controller.impulsive;
  return {.coast = g.coast,
          .stiffness_N_per_m = g.stiffness_N_per_m,
          .approach_damping_Ns_per_m = g.approach_damping_Ns_per_m,
          .kick_damping_Ns_per_m = g.kick_damping_Ns_per_m,
          .max_force_N = axis.controller.max_force_N,
          .max_approach_speed_m_s = axis.controller.max_approach_speed_m_s,
          .move = axis.move,
          .position_tolerance_m = axis.controller.position_tolerance_m,
          .settle_tolerance_m = node.settle_tolerance_m};
}

// What must be written to make the second of the first.
class Difference {
 public:
  void number(const char* table, const char* key, double before, double now) {
    if (now != before && std::isfinite(now)) settings_.push_back({table, key, fmt::format("{}", now)});
  }
  void word(const char* table, const char* key, const std::string& before, const std::string& now) {
    if (now != before) settings_.push_back({table, key, now});
  }
  std::vector<config::Setting> take() { return std::move(settings_); }

 private:
  std::vector<config::Setting> settings_;
};

std::vector<config::Setting> difference(const Gains& before, const Gains& now) {
  Difference d;
  d.word("controller", "coast", quoted(before.coast), quoted(now.coast));
  d.number("controller", "k1_N_per_m", before.stiffness_N_per_m, now.stiffness_N_per_m);
  d.number("controller", "k21_Ns_per_m", before.approach_damping_Ns_per_m, now.approach_damping_Ns_per_m);
  d.number("controller", "k22_Ns_per_m", before.kick_damping_Ns_per_m, now.kick_damping_Ns_per_m);
  d.number("controller", "max_force_N", before.max_force_N, now.max_force_N);
  d.number("controller", "max_approach_speed_m_s", before.max_approach_speed_m_s, now.max_approach_speed_m_s);
  d.number("controller", "position_tolerance_m", before.position_tolerance_m, now.position_tolerance_m);
  d.number("run", "settle_tolerance_m", before.settle_tolerance_m, now.settle_tolerance_m);
  if (now.move) {
    const config::Move none, &then = before.move ? *before.move : none;
    d.number("move", "distance_m", then.distance_m, now.move->distance_m);
    d.number("move", "speed_m_s", then.speed_m_s, now.move->speed_m_s);
    d.number("move", "acceleration_m_s2", then.acceleration_m_s2, now.move->acceleration_m_s2);
  }
  return d.take();
}

}  // namespace

std::string quoted(law::Coast coast) {
  return coast == law::Coast::pd ? "\"pd\"" : coast == law::Coast::brake ? "\"brake\"" : "\"work\"";
}

TunedAxis::TunedAxis(std::string text, std::string name, std::string axis)
    : text_{std::move(text)}, name_{std::move(name)}, wanted_{std::move(axis)}, scenario_{read_to_be_tuned()} {
  const config::Axis& alone = this->axis();
  if (!alone.controller.impulsive)
    throw InputError{"[controller] kind is \"pid\", which has no certificate to tune to; set kind = \"impulsive\""}
        .in_file(name_);
  gains_ = gains_of(scenario_.node, alone);
  alone_ = scenario::parse_scenario(text_, name_).axes() == 1;
  distance_m_ = longest_move_m();
  const double target_m = alone.controller.target_m;
  const bool from_above =
      scenario_.worlds.front().position_m > target_m || target_m - distance_m_ < alone.limits.position_min_m;
  start_ = {target_m + (from_above ? distance_m_ : -distance_m_), 0};
}

// What tuning chooses need not be right in the file.
scenario::Scenario TunedAxis::read_to_be_tuned() {
  const auto complete = [this](const std::string& text) {
    scenario::Scenario s = read(text);
    sil::require_complete(s);
    return s;
  };
  try {
    return complete(text_);
  } catch (const InputError&) {
    text_ = with_readable_choices(text_, name_, wanted_);
  }
  return complete(text_);
}

scenario::Scenario TunedAxis::read(const std::string& text) const {
  scenario::Scenario all = scenario::parse_scenario(text, name_);
  if (all.machine || all.node.coupling)
    throw InputError{
        "has axes that share a machine, and `tune` chooses gains of an axis alone; put a [machine] into a file of its "
        "own, without axes, loop and bus, and `breakaway synthesize` finds gains for it"}
        .in_file(name_);
  config::require_fitting_bus(all.node);
  if (all.axes() == 1 && wanted_.empty()) return all;
  if (wanted_.empty()) throw InputError{"has several axes: say which to tune with --axis NAME"}.in_file(name_);
  return only_axis(all, wanted_);
}

double TunedAxis::longest_move_m() const {
  if (axis().move) return axis().move->distance_m;
  const double target_m = axis().controller.target_m;
  const double away_m = std::abs(scenario_.worlds.front().position_m - target_m);
  if (away_m > 0) return away_m;
  constexpr double share_of_room = 0.8;
  const double room_m =
      share_of_room * std::max(target_m - axis().limits.position_min_m, axis().limits.position_max_m - target_m);
  if (std::isfinite(room_m) && room_m > 0) return room_m;
  throw InputError{"says nothing of how far the axis moves; give [move] distance_m, or [plant] position_m to begin at"}
      .in_file(name_);
}

double TunedAxis::hardest_m_s2() const {
  if (ideal()) return config::unlimited;
  const config::Uncertainty& u = axis().uncertainty;
  const double sure_N = config::law_force_N(axis()) * (1 - u.force_gain) - axis().friction.bounds.upper_N - u.force_N;
  return sure_N / (axis().mass_kg * (1 + u.mass));
}

double TunedAxis::fastest_m_s() const {
  if (ideal()) return config::unlimited;
  const double force_N = config::law_force_N(axis()), mass_kg = axis().mass_kg;
  const double helps_N = axis().friction.bounds.lower_N;
  const double faster = (force_N - helps_N) / mass_kg, slower = (force_N + helps_N) / mass_kg;
  return std::sqrt(2 * distance_m_ * faster * slower / (faster + slower));
}

double TunedAxis::allowed_m_s() const {
  constexpr double share_of_limit = 0.9;  // from which on the supervisor might stop the axis
  const double moved_m_s = axis().move ? axis().move->speed_m_s : config::unlimited;
  return std::min({gains_.max_approach_speed_m_s, share_of_limit * axis().limits.speed_m_s, moved_m_s});
}

double TunedAxis::duration_s(double settling_s) const {
  const scenario::Run& run = *scenario_.run;
  const auto& targets = axis().controller.targets;
  const double least_s = settling_s + run.settle_time_s + (targets.empty() ? 0 : targets.back().time_s);
  constexpr double room = 1.5;
  return run.duration_s >= least_s ? run.duration_s : rounded_up(room * least_s, 2);
}

std::string TunedAxis::text_with(const Gains& gains) const { return text_with(gains, scenario_.run->duration_s); }
std::string TunedAxis::text_with(const Gains& gains, double duration_s) const {
  std::vector<config::Setting> settings = difference(gains_, gains);
  if (duration_s != scenario_.run->duration_s) settings.push_back({"run", "duration_s", fmt::format("{}", duration_s)});
  return config::with_settings(text_, name_, wanted_, settings);
}

scenario::Scenario TunedAxis::with(const Gains& gains) const { return read(text_with(gains)); }

TunedAxis TunedAxis::changed(const std::vector<config::Setting>& settings) const {
  return {config::with_settings(text_, name_, wanted_, settings), name_, wanted_};
}

}  // namespace breakaway::study
