// Counts the instructions of the control step and of what stands around it, on a recorded run, for callgrind.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/design/k3.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/law.h"
#include "breakaway/model/shapes.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"
#include "callgrind_count.hpp"
#include "recording.hpp"
#include "replay.hpp"

namespace breakaway::bench {
namespace {

// Every update of a recorded run. The kind of a step is known after it only, so a first replay finds the labels.
template <class Real, class Controller>
void count_controller(const scenario::Scenario& s, const Controller& controller) {
  const Recording<Real> r = record<Real>(s, controller);
  std::vector<std::string> labels;
  replay(s, r, controller, [&](Controller& c, std::size_t i) {
    labels.push_back(label_prefix(c) + update_and_label(c, r.measurements[i]));
  });
  start_counting();
  replay(s, r, controller, [&](Controller& c, std::size_t i) {
    law::ControlOutput<Real> output;
    count(labels[i], [&] { output = c.update(r.measurements[i]); });
  });
  stop_counting();
}

template <class Real>
void count_law() {
  const scenario::Scenario s = axis_scenario();
  const auto table = build_table<Real>(s).table;
  const auto pulses = build_pulses<Real>(s);
  count_controller<Real>(s, law::AxisController<Real>{parameters<Real>(s), table, pulses});
  count_controller<Real>(s, pid_controller<Real>(s));
}

template <class Real, class Law>
void count_evaluator(const std::string& label, const Law& law, double range_m) {
  start_counting();
  for (const Real y : position_errors<Real>(range_m)) {
    Real impulse_Ns = 0;
    count(label, [&] { impulse_Ns = law.impulse_Ns(y); });
  }
  stop_counting();
}

void count_k3() {
  const scenario::Scenario s = axis_scenario();
  const auto small = build_table<float>(s);
  const auto large = build_table<double>(s);
  const auto exact = design::K3<double>::make(kick_plant(s));
  const double range_m = parameters<double>(s).stick_radius_upper_m();
  count_evaluator<float>("K3Table float", small.table, range_m);
  count_evaluator<double>("K3Table double", large.table, range_m);
  count_evaluator<double>("K3 double", exact, range_m);
  std::printf("fact K3Table float/bytes %zu\nfact K3Table float/proved error %.3g\n", small.size_bytes,
              small.proved_error);
  std::printf("fact K3Table double/bytes %zu\nfact K3Table double/proved error %.3g\n", large.size_bytes,
              large.proved_error);
  std::printf("fact K3 double/bytes %zu\n", sizeof exact);
}

void count_loop(std::size_t axes) {
  const scenario::Scenario s = axis_scenario(axes);
  const auto table = build_table<float>(s).table;
  const auto pulses = build_pulses<float>(s);
  const law::AxisController<float> controller{parameters<float>(s), table, pulses};
  const auto r = record<float>(s, controller, loop_steps * s.node.period_s());
  const std::string name = "ControlLoop " + std::to_string(axes);
  TapePort port;
  auto loop = make_loop<float>(port, s, controller);
  start_counting();
  for (std::size_t k = 0; k < r.steps.size(); ++k) {
    prepare_step(loop, port, r, k);
    count(name + (r.steps[k].running ? "/running" : "/set-up"), [&] { loop.step(r.time(k)); });
  }
  stop_counting();
  std::printf("fact %s/period_us %g\n", name.c_str(), s.node.period_s() * 1e6);
}

// A drive that runs, taken from the loop, in the order in which the loop calls it.
void count_drive() {
  const scenario::Scenario s = axis_scenario();
  const auto table = build_table<float>(s).table;
  const auto pulses = build_pulses<float>(s);
  const law::AxisController<float> controller{parameters<float>(s), table, pulses};
  const auto r = record<float>(s, controller, 1);
  TapePort port;
  const auto loop = loop_that_runs(port, s, controller, r);
  cia402::Drive<float> drive = loop.drive(*loop.axis(0));
  hal::CanFrame frame;
  start_counting();
  for (std::size_t k = r.first_running + 1; k < r.steps.size(); ++k) {
    for (hal::ReceivedFrame received : r.steps[k].received) {
      const bool feedback = received.frame.size == 8;
      count(feedback ? "Drive/on_frame, its feedback" : "Drive/on_frame, other", [&] { drive.on_frame(received); });
      received.frame.id = static_cast<std::uint16_t>(received.frame.id + 1);
      if (feedback) count("Drive/on_frame, another drive's feedback", [&] { drive.on_frame(received); });
    }
    count("Drive/update", [&] { drive.update(r.time(k)); });
    hal::DriveFeedback<float> feedback;
    count("Drive/feedback", [&] { feedback = drive.feedback(); });
    count("Drive/command and next_command_frame", [&] {
      drive.command(2.5F);
      drive.next_command_frame(frame);
    });
    drive.on_sync(r.time(k));
    count("Drive/next_acyclic_frame", [&] { drive.next_acyclic_frame(frame, r.time(k)); });
  }
  stop_counting();
}

// The forces of a recorded run on a plant alone. Under another friction law than the recorded one the motion differs,
// and so does nothing but the count.
void count_plant(const std::string& name, const scenario::Scenario& s, const Recording<float>& r) {
  Axis axis{s};
  start_counting();
  for (std::size_t k = 1; k < r.steps.size(); ++k) {
    const double before_m = axis.position_m();
    Axis ahead = axis;
    push(ahead, r.steps[k]);
    const bool moves = ahead.position_m() != before_m;
    count(name + (moves ? "/moving" : "/resting"), [&] { push(axis, r.steps[k]); });
  }
  stop_counting();
}

void count_emulator(const scenario::Scenario& s, const Recording<float>& r) {
  EmulatedAxis axis{s, 0};
  start_counting();
  for (std::size_t k = 1; k < r.steps.size(); ++k) {
    const std::string label = k > r.first_running ? "scenario/plant and drive emulator" : "scenario/set-up";
    count(label, [&] { axis.pass_period(r.steps[k - 1].sent, r.time(k - 1), r.time(k)); });
    axis.outbox().clear();
  }
  stop_counting();
}

// The whole scenario as the breakaway command runs it, less one that ends at once: set-up cancels.
void count_scenario(scenario::Scenario s) {
  s.run->stop_when_settled = false;
  const auto run = [&](double duration_s) {
    s.run->duration_s = duration_s;
    sil::Result result;
    start_counting();
    count(duration_s > s.node.period_s() ? "scenario/whole run" : "scenario/shortest run",
          [&] { result = sil::run_loop_scenario(s, {}); });
    stop_counting();
    return result.loop->ticks;
  };
  const auto shortest = run(s.node.period_s());
  const auto whole = run(tour[1].time_s);
  std::printf("fact scenario/ticks %llu\n", static_cast<unsigned long long>(whole - shortest));
}

void count_simulation() {
  scenario::Scenario s = axis_scenario();
  const auto table = build_table<float>(s).table;
  const auto pulses = build_pulses<float>(s);
  const law::AxisController<float> controller{parameters<float>(s), table, pulses};
  const auto r = record<float>(s, controller, tour[1].time_s);
  count_plant("plant, friction of can_axis", s, r);
  count_emulator(s, r);
  count_scenario(s);
  s.worlds[0].friction = {s.worlds[0].friction.bounds(), model::shape::constant(0.5)};
  count_plant("plant, constant friction", s, r);
}

// The example of van de Wouw & Leine with two masses, to its rest.
template <int N, int M>
void count_events(const std::string& size) {
  hybrid::LinearMachine<N, M> machine{Eigen::Matrix2d::Identity(), Eigen::Matrix2d{{0.125, 0.375}, {0.375, 0.125}},
                                      Eigen::Matrix2d{{2, -1}, {-1, 2}}, Eigen::Matrix2d::Identity(),
                                      Eigen::Vector2d::Ones()};
  const hybrid::EventDriven<N, M> integrator{machine};
  const hybrid::MachineState<N> start{0, Eigen::Vector2d{2.5, -1}, Eigen::Vector2d::Zero()};
  auto outcome = integrator.run(start, 60);  // modes are factorised when first met
  start_counting();
  count(size, [&] { outcome = integrator.run(start, 60); });
  stop_counting();
  std::printf("fact %s/segments %llu\n", size.c_str(), static_cast<unsigned long long>(outcome.steps));
}

// Every step of a recorded run by the class and through the C interface, one label for each.
void count_c_interface() {
  const scenario::Scenario s = axis_scenario();
  const auto flashed = config::certified(s.node, config::examine(s.node));
  const auto& axis = flashed.axes[0];
  const law::AxisController<float> fresh{axis.law, axis.k3_table, axis.kicks};
  const auto r = record<float>(s, fresh, tour[1].time_s);
  const auto image = config::law_image(flashed);
  breakaway_law_f c{};
  if (breakaway_law_f_init(&c, sizeof c, BREAKAWAY_LAW_ABI, image.data(), image.size(), 0) != BREAKAWAY_OK)
    throw InputError{"the law image is refused"};
  law::AxisController<float> cpp = fresh;
  const volatile float zero_m = 0;
  const float target_m = zero_m;
  int steps_in_kicks = 0;
  start_counting();
  for (std::size_t i = 0; i < std::min<std::size_t>(r.measurements.size(), 2000); ++i) {
    const law::Measurement<float>& m = r.measurements[i];
    float expected_N = 0, force_N = 0;
    law::Mode mode{};
    // What a program does with the class for what the interface gives: its position, its target, what the step was.
    count("C++ " + std::to_string(i), [&] {
      const law::ControlOutput<float> out = cpp.update({m.position_error_m - target_m, 0.0F, m.fresh});
      expected_N = out.force_N;
      mode = out.mode;
    });
    count("C " + std::to_string(i), [&] { force_N = breakaway_law_f_update(&c, m.position_error_m, m.fresh); });
    steps_in_kicks += mode == law::Mode::kick ? 1 : 0;
    if (expected_N < force_N || expected_N > force_N) throw InputError{"the forces differ"};
  }
  stop_counting();
  std::printf("fact C/steps in kicks %d\n", steps_in_kicks);
}

int run(std::string_view part) {
  const std::map<std::string_view, std::function<void()>> parts{
      {"law", [] { count_law<float>(), count_law<double>(); }},
      {"c", count_c_interface},
      {"k3", count_k3},
      {"drive", count_drive},
      {"loop",
       [] {
         for (const std::size_t axes : {1U, 2U, 4U, 8U}) count_loop(axes);
       }},
      {"simulation", count_simulation},
      {"events",
       [] {
         count_events<2, 2>("compiled size");
         count_events<Eigen::Dynamic, Eigen::Dynamic>("any size");
       }},
      {"tick", [] { count_scenario(axis_scenario()); }}};
  if (!can_count() || !parts.contains(part)) {
    std::fputs(
        "usage: valgrind --tool=callgrind --instr-atstart=no --combine-dumps=yes \\\n"
        "         step_count law|c|k3|drive|loop|simulation|events|tick\n",
        stderr);
    return 2;
  }
  parts.at(part)();
  return 0;
}

}  // namespace
}  // namespace breakaway::bench

int main(int argc, char** argv) {
  try {
    return breakaway::bench::run(argc == 2 ? argv[1] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "step_count: %s\n", error.what());
    return 1;
  }
}
