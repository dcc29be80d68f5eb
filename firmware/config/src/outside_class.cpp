#include "outside_class.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/odrive/polled_timing.hpp"

namespace breakaway::config {
namespace {

using law::Coast;

constexpr double rounding = 1e-9;  // relative: a bound that is set to the very number holds it

// As sentences have numbers, of six digits, that are typed in as bounds: of what is at most so much, and at least.
double at_most(double value) { return value > 0 && std::isfinite(value) ? rounded_up(value, 6) : value; }
double at_least(double value) { return value > 0 ? rounded_down(value, 6) : value; }

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
    const double beside_N = left_N() + s.cogging_N + ripple_N, stated_N = at_most(beside_N);
    if (beside_N == 0) return;
    if (!braked())
      add("[plant] has {:.6g} N act beside the drive's force, of which the coast \"pd\" knows nothing; feed "
          "a constant force forward by feedforward_N, or take coast = \"brake\" with [uncertainty] force_N = {:.6g}",
          stated_N, stated_N);
    else if (beside_N > axis_.uncertainty.force_N * (1 + rounding))
      add("[plant] has {:.6g} N act beside the drive's force (what feedforward_N leaves of force_N, cogging, and the "
          "ripple of the greatest force), above [uncertainty] force_N = {:.6g}; raise that",
          stated_N, axis_.uncertainty.force_N);
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
    const double off_m = axis_.surroundings.encoder_error_m;
    const double told_m = axis_.uncertainty.encoder_noise_m - rounding_m(axis_);
    if (off_m == 0 || (braked() && off_m <= told_m * (1 + rounding))) return;
    add("[plant] encoder_error: a reading may be {:.6g} m off beside its count (interpolation_m and 6 times noise_m), "
        "and [uncertainty] encoder_noise_m = {:.6g} is less; raise that, under coast = \"brake\"",
        at_most(off_m), told_m);
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
          at_least(least_N), at_most(most_N), told.lower_N, told.upper_N);
    const double rise = s.rise_per_m_s > 0 ? s.rise_per_m_s * (truth.upper_N - truth.lower_N) * (1 + s.drift) : 0;
    if (!braked() && rise > axis_.friction.smooth_slope_Ns_per_m * (1 + rounding))
      add("[friction] law rises with speed, by {:.6g} N s/m at its steepest, and the approach under the coast \"pd\" "
          "may creep for ever where smooth_slope_Ns_per_m = {:.6g} is less; state it there, or take coast = \"brake\"",
          at_most(rise), axis_.friction.smooth_slope_Ns_per_m);
    if (braked() && axis_.friction.smooth_slope_Ns_per_m != 0)
      add("[friction] smooth_slope_Ns_per_m = {:.6g} is a force beside the dry friction, which the coast \"brake\" "
          "does not know; widen the bounds so that they hold it at the greatest speed, and leave it out",
          axis_.friction.smooth_slope_Ns_per_m);
  }

  void presliding() {
    const double stiffness = axis_.surroundings.bristles.stiffness_N_per_m;
    const double told = axis_.friction.presliding_stiffness_N_per_m;
    if (told > 0 && without_sync() && braked())
      add("[friction] presliding_stiffness_N_per_m: a certificate is of friction that bends in whole periods, and "
          "[drive] protocol = \"odrive\" has no SYNC; take protocol = \"canopen\", or simulate it");
    if (stiffness == 0) return;
    if (told == 0) {
      add("[plant] presliding: a certificate is of friction that holds the axis without a spring, and here it bends "
          "before it slides; state [friction] presliding_stiffness_N_per_m = {:.6g} under the coast \"brake\", "
          "simulate it, or leave the table out where the bending is far below a count",
          at_least(stiffness));
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
    const double apart_s = b.most_delay_s - b.least_delay_s, stated_s = at_most(apart_s),
                 jitter_s = axis_.uncertainty.jitter_s;
    if (apart_s > 0 && !braked())
      add("[bus] delay_max_s = {:g} is above delay_min_s, so that a kick may be longer or shorter than its periods; "
          "make them equal, or take coast = \"brake\" with [uncertainty] jitter_s = {:g}",
          b.most_delay_s, stated_s);
    else if (apart_s > jitter_s * (1 + rounding))
      add("[bus] delay_max_s = {:g} and delay_min_s are {:g} s apart, so that a kick may be as much longer or shorter "
          "than its periods, and [uncertainty] jitter_s = {:g} is less; raise that",
          b.most_delay_s, stated_s, jitter_s);
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
    if (std::string late = late_answer(node_, axis_); !late.empty()) all_.push_back(std::move(late));
  }

  const Node& node_;
  const Axis& axis_;
  std::vector<std::string> all_;
  const ImpulsiveGains& gains_;
};

}  // namespace

std::string late_answer(const Node& node, const Axis& axis) {
  const auto needed_us =
      canopen::bus_budget(static_cast<unsigned>(node.axes.size()), node.loop->period, *node.bit_rate).needed_us;
  const double delay_s = answer_delay_s(node, axis);
  if (!(delay_s + 1e-6 * needed_us > node.period_s() * (1 + rounding))) return {};
  return fmt::format(
      "[bus] and [drive] delay a reading by {:.6g} s beside the {} us of its frames, so that it comes too late for its "
      "period; lower delay_max_s or tpdo_delay_max_s, or take a longer period_s",
      delay_s, needed_us);
}

std::vector<std::string> outside_class(const Node& node, const Axis& axis) { return Outside{node, axis}.sentences(); }

}  // namespace breakaway::config
