#include "breakaway/sil/run_scenario.hpp"

#include <fmt/format.h>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/axis_accuracy.hpp"
#include "breakaway/sil/run_ideal_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"

namespace breakaway::sil {
namespace {

using config::unlimited;

// Of one axis among several, the text says which.
class Requirements {
 public:
  Requirements(const scenario::Scenario& s, const config::Axis* axis = nullptr)
      : file_{s.node.file}, prefix_{axis != nullptr && s.axes() > 1 ? "axis " + axis->name + ": " : std::string{}} {}

  void operator()(bool holds, const std::string& otherwise) const {
    if (!holds) throw InputError{prefix_ + otherwise}.in_file(file_);
  }

 private:
  const std::string& file_;
  std::string prefix_;
};

// What the ideal law, which is continuous, cannot be run on.
void check_ideal(const scenario::Scenario& s, const config::Axis& axis, const scenario::AxisWorld& world) {
  const Requirements require{s, &axis};
  const config::Controller& c = axis.controller;
  require(!axis.drive && !s.bus, "[loop] is missing: a scenario with a [drive] needs it");
  require(c.impulsive.has_value(), "[loop] is missing: a pid controller runs in a loop only, with a [drive]");
  require(c.impulsive->kick == config::Kick::ideal, "[controller] kick must be \"ideal\" in a scenario without [loop]");
  require(c.max_force_N == unlimited && c.max_approach_speed_m_s == unlimited && c.position_tolerance_m == 0,
          "[controller] max_force_N, max_approach_speed_m_s and position_tolerance_m need a [loop]: the ideal law has "
          "none");
  require(!s.machine, "a [machine] behind an axis needs a [loop] and a [drive]: the ideal law is for a rigid axis");
  require(axis.latency_periods == 1, "[told] latency_periods needs a [loop]: the ideal law has no periods");
  require(
      world.plant.rigid() && !world.encoder_error,
      "[plant] presliding, load, backlash, cogging, ripple and encoder_error need a [loop] and a [drive]: the ideal "
      "law acts on a rigid axis and sees where it is");
}

void check_sampled(const scenario::Scenario& s, const config::Axis& axis) {
  const Requirements require{s, &axis};
  require(axis.drive.has_value(), "[drive] is missing: a scenario with a [loop] needs it");
  const double force_N = config::law_force_N(axis), friction_N = axis.friction.bounds.upper_N;
  require(
      force_N > friction_N,
      fmt::format("[controller] max_force_N is {}, must exceed the upper friction bound {} N, or no kick is sure to "
                  "move the axis",
                  force_N, friction_N));
  require(judged_tolerance_m(s.node, axis) > config::reading_error_m(axis),
          "[controller] position_tolerance_m is missing: say which accuracy the axis shall reach");
}

}  // namespace

void require_complete(const scenario::Scenario& s) {
  Requirements{s}(s.run.has_value(), "[run] is missing: say how long to simulate with duration_s");
  for (std::size_t i = 0; i < s.axes(); ++i)
    s.ideal() ? check_ideal(s, s.node.axes[i], s.worlds[i]) : check_sampled(s, s.node.axes[i]);
}

Result run_scenario(const scenario::Scenario& s, const RecordingOptions& recording) {
  require_complete(s);
  if (s.run->accuracy_m) {
    const Accuracy accuracy = choose_method(s);
    Result result = run_scenario(with_method(s, accuracy.method), recording);
    result.accuracy = accuracy;
    return result;
  }
  try {
    return s.ideal() ? run_ideal_scenario(s, recording) : run_loop_scenario(s, recording);
  } catch (const hybrid::Refused& refusal) {
    throw refusal.without_another_method().in_file(s.node.file);
  } catch (const InputError& refusal) {
    if (s.node.file.empty() || !refusal.file().empty()) throw;
    throw refusal.in_file(s.node.file);
  }
}

}  // namespace breakaway::sil
