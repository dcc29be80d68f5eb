#include <cmath>
#include <memory>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "parts.hpp"
#include "scene_parts.hpp"

namespace breakaway::tradeoff {
namespace {

using scenario::Scenario;

constexpr double duration_s = 1;

config::Axis& axis(Scenario& s) { return s.node.axes.front(); }
scenario::AxisWorld& world(Scenario& s) { return s.worlds.front(); }

// Motion, kicks and rest: from 0.1 m, and a short move after half of the time.
Scenario moving_axis() {
  Scenario s = can_axis();
  world(s).position_m = -0.1;
  world(s).velocity_m_s = 0;
  axis(s).controller.targets = {{duration_s / 2, 0.01}};
  s.run->stop_when_settled = false;
  return s;
}

void give_friction(Scenario& s, model::ShapePtr shape) {
  world(s).friction = {axis(s).friction.bounds, std::move(shape)};
}

// A carriage on a stiff belt, which moves freely, beside a mass of 1 kg.
void give_load(Scenario& s, double gap_m) {
  model::FlexibleLoad& load = world(s).plant.load.emplace();
  load.mass_kg = 0.6;
  load.coupling = {.stiffness_N_per_m = 1e6, .damping_Ns_per_m = 150, .gap_m = gap_m};
}

Scenario with(void (*change)(Scenario&)) {
  Scenario s = moving_axis();
  change(s);
  return s;
}

struct Part {
  std::string name, work;
  void (*change)(Scenario&);
  sil::RecordingOptions recording{};
};

std::vector<Part> parts() {
  return {
      {"can_axis: drive, bus, lag, encoder of 1 um, Stribeck and sine friction", "scenario-whole", [](Scenario&) {}},
      {"constant friction", "scenario-constant-friction",
       [](Scenario& s) { give_friction(s, model::shape::constant(0.5)); }},
      {"random friction, new at every stick and slip", "scenario-random-friction",
       [](Scenario& s) { give_friction(s, model::shape::random_dwell({})); }},
      {"no lag of the current loop", "scenario-no-lag",
       [](Scenario& s) { world(s).drive->current_loop_time_constant_s = 0; }},
      {"encoder of 1 nm", "scenario-fine-encoder",
       [](Scenario& s) { axis(s).drive->encoder_resolution_m = world(s).drive->encoder_resolution_m = 1e-9; }},
      {"jitter and loss on the bus", "scenario-bad-bus",
       [](Scenario& s) {
         world(s).drive->max_tpdo_delay = std::chrono::microseconds{100};
         s.bus->loss_probability = 0.01;
       }},
      {"encoder noise and interpolation error", "scenario-encoder-error",
       [](Scenario& s) {
         world(s).encoder_error = model::EncoderErrorParameters{2e-7, {.amplitude = 2e-7, .period_m = 2e-5}};
       }},
      {"friction that drifts by 5 %", "scenario-drift",
       [](Scenario& s) { world(s).drift = model::FrictionDrift{.share = 0.05, .period_s = 2}; }},
      {"cogging and torque ripple", "scenario-cogging",
       [](Scenario& s) {
         world(s).plant.cogging = {.amplitude = 0.3, .period_m = 2e-3};
         world(s).plant.ripple = {.amplitude = 0.02, .period_m = 3e-3};
       }},
      {"a load behind a spring", "scenario-load", [](Scenario& s) { give_load(s, 0); }},
      {"a load behind a spring with backlash", "scenario-backlash", [](Scenario& s) { give_load(s, 2e-5); }},
      {"pre-sliding friction, Dahl", "scenario-dahl",
       [](Scenario& s) { world(s).plant.presliding = model::Presliding{.stiffness_N_per_m = 1e7}; }},
      {"pre-sliding friction, LuGre", "scenario-lugre",
       [](Scenario& s) {
         world(s).plant.presliding = model::Presliding{.stiffness_N_per_m = 1e7, .damping_Ns_per_m = 3e3};
       }},
      {"trace and frames recorded", "scenario-recorded", [](Scenario&) {}, {.trace = true, .frames = true}},
      {"no loop: the ideal law on the plant", "scenario-ideal", leave_out_the_loop},
      {"no loop, constant friction", "scenario-ideal-constant-friction",
       [](Scenario& s) {
         leave_out_the_loop(s);
         give_friction(s, model::shape::constant(0.5));
       }},
  };
}

// A run of the part that lasts for the shortest time is what setting it up costs.
Work work_of(const Part& part, bool set_up_only) {
  return {part.work + (set_up_only ? "-set-up" : ""),
          [part, set_up_only]() -> std::function<void()> {
            const auto s = std::make_shared<Scenario>(with(part.change));
            s->run->duration_s = set_up_only ? 1e-3 : duration_s + 1e-3;
            return
                [s, recording = part.recording] { keep(sil::run_scenario(*s, recording).axes.front().final_error_m); };
          },
          1};
}

// The final position under the law, sampled, on the plant alone.
double run_without_drive(const Scenario& s, const firmware::FlashedAxis<float>& flashed) {
  const config::Axis& axis = s.node.axes.front();
  const scenario::AxisWorld& world = s.worlds.front();
  law::AxisController<float> controller{flashed.law, flashed.k3_table, flashed.kicks};
  motion::Slide slide{axis.mass_kg, world.friction, {0, world.position_m, 0}};
  const double resolution_m = axis.drive->encoder_resolution_m, period_s = s.node.period_s();
  const config::TargetChange& change = axis.controller.targets.front();
  double target_m = 0, force_N = 0;
  for (int tick = 1; tick * period_s <= duration_s; ++tick) {
    const double time_s = tick * period_s;
    if (target_m == 0 && time_s >= change.time_s) {
      target_m = change.position_m;
      controller.shift_target(static_cast<float>(target_m));
    }
    const double read_m = resolution_m * std::round(slide.state().position_m / resolution_m);
    const auto out = controller.update({static_cast<float>(read_m - target_m), 0, true});
    slide.advance_to(time_s, {.constant_N = force_N});
    force_N = static_cast<double>(out.force_N);
  }
  return slide.state().position_m;
}

// The law, sampled, and the plant: neither drive nor bus, an encoder and one period of delay.
Work loop_without_drive() {
  return {"scenario-no-drive",
          []() -> std::function<void()> {
            const Scenario s = moving_axis();
            const auto flashed = std::make_shared<firmware::FlashedAxis<float>>(config::flashed<float>(s.node).axes[0]);
            return [=] { keep(run_without_drive(s, *flashed)); };
          },
          duration_s};
}

// Below this share of setting up, a difference of two times is noise.
constexpr double least_share = 0.05;

const char* const without_drive = "no drive, no bus: law, encoder and plant only";

}  // namespace

// Whole, set-up, whole, set-up, ..., and the loop without a drive.
std::vector<Work> scenario_part_works() {
  std::vector<Work> works;
  for (const Part& part : parts()) {
    works.push_back(work_of(part, false));
    works.push_back(work_of(part, true));
  }
  works.push_back(loop_without_drive());
  return works;
}

std::vector<ScenarioPartRow> measure_scenario_parts(const Options& options) {
  const auto costs = measure_costs(scenario_part_works(), options.counting);
  std::vector<ScenarioPartRow> rows;
  const auto all = parts();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Cost &whole = costs[2 * i], &set_up = costs[2 * i + 1];
    const double time_ratio = whole.time_ratio - set_up.time_ratio;
    rows.push_back({all[i].name,
                    {(whole.instructions - set_up.instructions) / duration_s,
                     time_ratio > least_share * set_up.time_ratio ? time_ratio / duration_s : not_measured}});
  }
  rows.push_back({without_drive, costs.back()});
  const double unit = rows.front().second.time_ratio;
  for (ScenarioPartRow& row : rows) row.second.time_ratio /= unit;
  return rows;
}

}  // namespace breakaway::tradeoff
