// What a supervisor may expect of an axis, as far as its law knows it: one that is designed for a mass and its friction
// does, a law of one's own need not.
#pragma once

#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::firmware {

template <class Controller>
concept KnowsFriction = requires(const Controller& c) {
  c.parameters().friction.upper_N;
};

// It says what motion a force must bring.
template <class Scalar, class Controller>
AxisModel<Scalar> model_of(const Controller& c) noexcept {
  AxisModel<Scalar> model{.max_force_N = c.max_force_N()};
  if constexpr (KnowsFriction<Controller>) {
    model.mass_kg = c.parameters().mass_kg;
    model.breakaway_N = c.parameters().friction.upper_N;
    model.feedforward_N = c.parameters().feedforward_N;
    model.encoder_resolution_m = c.parameters().encoder_resolution_m;
  }
  if constexpr (requires { c.parameters().unseen_m(); }) model.unseen_m = c.parameters().unseen_m();
  if constexpr (requires { c.breakaway_N(); }) model.breakaway_N = c.breakaway_N();
  if constexpr (requires { c.lost_motion_m(); }) model.lost_motion_m = c.lost_motion_m();
  if constexpr (requires { c.slow_lag(); }) model.slow_lag = c.slow_lag();
  if constexpr (requires { c.held(); }) model.held = c.held();
  return model;
}

// Only a law that is designed for its friction is sure to reach its target.
template <class Controller>
bool is_on_its_way(const Controller& c) noexcept {
  if constexpr (requires { c.waits(); }) {
    if (c.waits()) return false;
  }
  if constexpr (KnowsFriction<Controller>) return c.mode() != law::Mode::hold;
  return false;
}

}  // namespace breakaway::firmware
