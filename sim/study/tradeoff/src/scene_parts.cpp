#include "scene_parts.hpp"

#include <algorithm>

#include "breakaway/model/shapes.hpp"

namespace breakaway::tradeoff {
namespace {

using scenario::AxisWorld;
using scenario::MachineScenario;
using scenario::Scenario;

constexpr double finer = 16;  // an encoder this much finer stands for one without steps

template <class Holds>
bool any_world(const Scenario& s, Holds holds) {
  return std::ranges::any_of(s.worlds, holds);
}

template <class Change>
void each_world(Scenario& s, Change change) {
  for (AxisWorld& world : s.worlds) change(world);
}

template <class Change>
void each_drive(Scenario& s, Change change) {
  for (std::size_t i = 0; i < s.axes(); ++i) {
    if (s.worlds[i].drive) change(*s.worlds[i].drive, *s.node.axes[i].drive);
  }
}
// What drives of either protocol have.
template <class Change>
void each_drive_of_any_protocol(Scenario& s, Change change) {
  each_drive(s, change);
  for (std::size_t i = 0; i < s.axes(); ++i) {
    if (s.worlds[i].odrive) change(*s.worlds[i].odrive, *s.node.axes[i].drive);
  }
}

double lag_s(const AxisWorld& world) {
  if (world.odrive) return world.odrive->current_loop_time_constant_s;
  return world.drive ? world.drive->current_loop_time_constant_s : 0;
}

void give_constant_friction(MachineScenario& s) {
  for (std::size_t i = 0; i < s.laws.size(); ++i) {
    const auto& bounds = s.laws[i].bounds();
    s.machine.friction_N[static_cast<Eigen::Index>(i)] = (bounds.lower_N + bounds.upper_N) / 2;
  }
  s.laws.clear();
  s.integrator = scenario::Integrator::event_driven;
  s.integrator_is_named = false;
}

}  // namespace

void leave_out_the_loop(Scenario& s) {
  s.node.loop.reset();
  s.node.bit_rate.reset();
  s.bus.reset();
  for (std::size_t i = 0; i < s.axes(); ++i) {
    s.worlds[i].drive.reset();
    s.worlds[i].odrive.reset();
    config::Axis& axis = s.node.axes[i];
    axis.drive.reset();
    axis.limits = {};
    config::Controller& c = axis.controller;
    c.max_force_N = c.max_approach_speed_m_s = config::unlimited;
    c.position_tolerance_m = 0;
    if (c.impulsive) c.impulsive->kick = config::Kick::ideal;
  }
}

const std::vector<ScenePart<Scenario>>& axis_parts() {
  static const std::vector<ScenePart<Scenario>> parts{
      {"lag of the drive",
       [](const Scenario& s) { return any_world(s, [](const AxisWorld& w) { return lag_s(w) > 0; }); },
       [](Scenario& s) {
         each_drive_of_any_protocol(s, [](auto& world, auto&) { world.current_loop_time_constant_s = 0; });
       }},
      {"steps of the encoder",
       [](const Scenario& s) { return any_world(s, [](const AxisWorld& w) { return w.drive || w.odrive; }); },
       [](Scenario& s) {
         each_drive_of_any_protocol(
             s, [](auto& world, auto& told) { told.encoder_resolution_m = world.encoder_resolution_m /= finer; });
       }},
      {"errors of the encoder",
       [](const Scenario& s) { return any_world(s, [](const AxisWorld& w) { return w.encoder_error.has_value(); }); },
       [](Scenario& s) { each_world(s, [](AxisWorld& w) { w.encoder_error.reset(); }); }},
      {"what friction depends on",
       [](const Scenario& s) {
         return any_world(s, [](const AxisWorld& w) { return !w.friction.constant_between_events(); });
       },
       [](Scenario& s) {
         each_world(s, [](AxisWorld& w) { w.friction = {w.friction.bounds(), model::shape::constant(0.5)}; });
       }},
      {"drift of friction",
       [](const Scenario& s) { return any_world(s, [](const AxisWorld& w) { return w.drift.has_value(); }); },
       [](Scenario& s) { each_world(s, [](AxisWorld& w) { w.drift.reset(); }); }},
      {"constant force",
       [](const Scenario& s) {
         return (s.machine && !stability::constant_force(s.machine->machine).isZero(0)) ||
                any_world(s, [](const AxisWorld& w) { return w.plant.force_N != 0; });
       },
       [](Scenario& s) {
         if (s.machine) s.machine->machine.force_N.setZero();
         each_world(s, [](AxisWorld& w) { w.plant.force_N = 0; });
       }},
      {"pre-sliding",
       [](const Scenario& s) {
         return any_world(s, [](const AxisWorld& w) { return w.plant.presliding.has_value(); });
       },
       [](Scenario& s) { each_world(s, [](AxisWorld& w) { w.plant.presliding.reset(); }); }},
      {"backlash", [](const Scenario& s) { return any_world(s, [](const AxisWorld& w) { return w.gap_m > 0; }); },
       [](Scenario& s) {
         each_world(s, [](AxisWorld& w) {
           w.gap_m = 0;
           if (w.plant.load) w.plant.load->coupling.gap_m = 0;
         });
       }},
      {"cogging and torque ripple",
       [](const Scenario& s) {
         return any_world(
             s, [](const AxisWorld& w) { return w.plant.cogging.amplitude != 0 || w.plant.ripple.amplitude != 0; });
       },
       [](Scenario& s) {
         each_world(s, [](AxisWorld& w) { w.plant.cogging.amplitude = w.plant.ripple.amplitude = 0; });
       }},
      {"jitter and loss on the bus",
       [](const Scenario& s) {
         return s.bus && (s.bus->loss_probability > 0 || s.bus->max_delay > s.bus->min_delay ||
                          any_world(s, [](const AxisWorld& w) {
                            return w.drive && w.drive->max_tpdo_delay > w.drive->min_tpdo_delay;
                          }));
       },
       [](Scenario& s) {
         s.bus->loss_probability = 0;
         s.bus->max_delay = s.bus->min_delay;
         each_drive(s, [](auto& world, auto&) { world.max_tpdo_delay = world.min_tpdo_delay; });
       }},
      {"loop, drive and bus", [](const Scenario& s) { return !s.ideal(); }, leave_out_the_loop},
  };
  return parts;
}

const std::vector<ScenePart<MachineScenario>>& machine_parts() {
  static const std::vector<ScenePart<MachineScenario>> parts{
      {"what friction depends on", [](const MachineScenario& s) { return !s.laws.empty(); }, give_constant_friction},
      {"constant force", [](const MachineScenario& s) { return !stability::constant_force(s.machine).isZero(0); },
       [](MachineScenario& s) { s.machine.force_N.setZero(); }},
      {"impulses", [](const MachineScenario& s) { return !s.impulses.empty(); },
       [](MachineScenario& s) { s.impulses.clear(); }},
  };
  return parts;
}

}  // namespace breakaway::tradeoff
