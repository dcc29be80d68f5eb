// What both programs here do with a recording.
#pragma once

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "recording.hpp"

namespace breakaway::bench {

// The kinds of step of AxisController that differ in their work.
inline constexpr std::array<const char*, 7> all_kinds{
    "approach", "coast", "hold", "kick of one period", "kick of many periods starts", "kick goes on", "lost sample"};

template <class Real>
std::string update_and_label(law::AxisController<Real>& controller, const law::Measurement<Real>& sample) {
  const law::Mode before = controller.mode();
  const law::ControlOutput<Real> output = controller.update(sample);
  if (!sample.fresh) return "lost sample";
  if (output.kicked) return controller.mode() == law::Mode::kick ? "kick of many periods starts" : "kick of one period";
  return before == law::Mode::kick ? "kick goes on" : std::string{to_string(output.mode)};
}

template <class Real>
std::string update_and_label(law::PidController<Real>& controller, const law::Measurement<Real>& sample) {
  controller.update(sample);
  return sample.fresh ? "step" : "lost sample";
}

template <class Real>
std::string label_prefix(const law::AxisController<Real>&) {
  return std::is_same_v<Real, float> ? "AxisController float/" : "AxisController double/";
}
template <class Real>
std::string label_prefix(const law::PidController<Real>&) {
  return std::is_same_v<Real, float> ? "PidController float/" : "PidController double/";
}

// A controller alone on the samples of a recording: update(controller, i) is to take measurement i.
template <class Real, class Controller, class Update>
void replay(const scenario::Scenario& s, const Recording<Real>& r, Controller controller, const Update& update) {
  const auto metres_per_count = static_cast<Real>(resolution_m(s));
  controller.reset();
  for (std::size_t i = 0; i < r.measurements.size(); ++i) {
    const std::size_t k = r.first_running + i;
    const std::int32_t shift = r.steps[k].target_counts - r.steps[k - 1].target_counts;
    if (shift != 0) controller.shift_target(static_cast<Real>(shift) * metres_per_count);
    update(controller, i);
  }
}

// Over the whole stick set, from a millionth of it on, in even ratios.
template <class Real>
std::vector<Real> position_errors(double range_m) {
  constexpr int points = 200;
  std::vector<Real> errors_m;
  for (int i = 0; i < points; ++i) errors_m.push_back(static_cast<Real>(range_m * std::pow(10.0, -6.0 * i / points)));
  return errors_m;
}

inline constexpr double loop_steps = 1500;

// A loop in the state right after the first step in which all axes run.
template <class Real, class Controller>
Loop<Real, Controller> loop_that_runs(TapePort& port, const scenario::Scenario& s, const Controller& controller,
                                      const Recording<Real>& r) {
  auto loop = make_loop<Real>(port, s, controller);
  for (std::size_t k = 0; k <= r.first_running; ++k) run_step(loop, port, r, k);
  return loop;
}

// The forces of one step on a plant alone.
inline void push(Axis& axis, const RecordedStep& step) {
  for (const ForceSegment& segment : step.forces) axis.advance_to(segment.until_s, segment.force);
}

}  // namespace breakaway::bench
