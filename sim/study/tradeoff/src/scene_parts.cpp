#include <cmath>
#include <memory>

#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "parts.hpp"

namespace breakaway::tradeoff {
namespace {

using scenario::Scenario;

constexpr double duration_s = 1;

// Motion, kicks and rest: from 0.1 m, and a short move after half of the time.
Scenario moving_axis() {
  Scenario s = can_axis();
  s.plant.position_m = -0.1;
  s.plant.velocity_m_s = 0;
  s.controller.targets = {{duration_s / 2, 0.01}};
  s.run->stop_when_settled = false;
  return s;
}

model::FrictionLaw law_of(const Scenario& s, model::ShapePtr shape) {
  return {s.friction.law.bounds(), std::move(shape)};
}

Scenario with(void (*change)(Scenario&)) {
  Scenario s = moving_axis();
  change(s);
  return s;
}

void leave_out_the_loop(Scenario& s) {
  s.loop.reset();
  s.drive.reset();
  s.bus.reset();
  s.limits = {};
  s.controller.max_force_N = s.controller.max_approach_speed_m_s = scenario::unlimited;
  s.controller.position_tolerance_m = 0;
  s.controller.impulsive->kick = scenario::Kick::ideal;
}

struct Part {
  std::string name, work;
  void (*change)(Scenario&);
  sil::RecordingOptions recording{};
};

std::vector<Part> parts() {
  return {
      {"can_axis: drive, bus, lag, encoder of 1 um, Stribeck and sine friction", "scene-whole", [](Scenario&) {}},
      {"constant friction", "scene-constant-friction",
       [](Scenario& s) { s.friction.law = law_of(s, model::shape::constant(0.5)); }},
      {"random friction, new at every stick and slip", "scene-random-friction",
       [](Scenario& s) { s.friction.law = law_of(s, model::shape::random_dwell({})); }},
      {"no lag of the current loop", "scene-no-lag", [](Scenario& s) { s.drive->current_loop_time_constant_s = 0; }},
      {"encoder of 1 nm", "scene-fine-encoder", [](Scenario& s) { s.drive->encoder_resolution_m = 1e-9; }},
      {"jitter and loss on the bus", "scene-bad-bus",
       [](Scenario& s) {
         s.drive->max_tpdo_delay = std::chrono::microseconds{100};
         s.bus->loss_probability = 0.01;
       }},
      {"trace and frames recorded", "scene-recorded", [](Scenario&) {}, {.trace = true, .frames = true}},
      {"no loop: the ideal law on the plant", "scene-ideal", leave_out_the_loop},
      {"no loop, constant friction", "scene-ideal-constant-friction",
       [](Scenario& s) {
         leave_out_the_loop(s);
         s.friction.law = law_of(s, model::shape::constant(0.5));
       }},
  };
}

// A run of the part that lasts for the shortest time is what setting it up costs.
Work work_of(const Part& part, bool set_up_only) {
  return {part.work + (set_up_only ? "-set-up" : ""),
          [part, set_up_only]() -> std::function<void()> {
            const auto s = std::make_shared<Scenario>(with(part.change));
            s->run->duration_s = set_up_only ? 1e-3 : duration_s + 1e-3;
            return [s, recording = part.recording] { keep(sil::run_scenario(*s, recording).final_error_m); };
          },
          1};
}

// The law, sampled, and the plant: neither drive nor bus, an encoder and one period of delay.
Work loop_without_drive() {
  return {"scene-no-drive",
          []() -> std::function<void()> {
            const Scenario s = moving_axis();
            const auto p = scenario::axis_parameters<float>(s);
            const auto table = std::make_shared<law::K3Table<float>>(
                design::build_k3_table<float>(
                    {s.plant.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N},
                    p.stick_radius_upper_m())
                    .table);
            return [=] {
              law::AxisController<float> controller{p, *table};
              motion::Slide slide{s.plant.mass_kg, s.friction.law, {0, s.plant.position_m, 0}};
              const double resolution_m = s.drive->encoder_resolution_m;
              double target_m = 0, force_N = 0;
              for (int tick = 1; tick * s.loop->period_s <= duration_s; ++tick) {
                const double time_s = tick * s.loop->period_s;
                if (target_m == 0 && time_s >= s.controller.targets[0].time_s) {
                  target_m = s.controller.targets[0].position_m;
                  controller.shift_target(static_cast<float>(target_m));
                }
                const double read_m = resolution_m * std::round(slide.state().position_m / resolution_m);
                const auto out = controller.update({static_cast<float>(read_m - target_m), 0, true});
                slide.advance_to(time_s, {.constant_N = force_N});
                force_N = static_cast<double>(out.force_N);
              }
              keep(slide.state().position_m);
            };
          },
          duration_s};
}

// Below this share of setting up, a difference of two times is noise.
constexpr double least_share = 0.05;

const char* const without_drive = "no drive, no bus: law, encoder and plant only";

}  // namespace

// Whole, set-up, whole, set-up, ..., and the loop without a drive.
std::vector<Work> scene_part_works() {
  std::vector<Work> works;
  for (const Part& part : parts()) {
    works.push_back(work_of(part, false));
    works.push_back(work_of(part, true));
  }
  works.push_back(loop_without_drive());
  return works;
}

std::vector<ScenePartRow> measure_scene_parts(const Options& options) {
  const auto costs = measure_costs(scene_part_works(), options.counting);
  std::vector<ScenePartRow> rows;
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
  for (ScenePartRow& row : rows) row.second.time_ratio /= unit;
  return rows;
}

}  // namespace breakaway::tradeoff
