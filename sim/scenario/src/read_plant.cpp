#include "read_plant.hpp"

#include <optional>
#include <utility>

#include "breakaway/config/read_node.hpp"
#include "breakaway/model/shapes.hpp"
#include "read_friction.hpp"

namespace breakaway::scenario {

using namespace config;
namespace {

constexpr Range along_travel{1e-6, 1e6};

Key period(model::PositionSine& sine) { return required("period_m", number(sine.period_m, "m", along_travel)); }
Key phase(model::PositionSine& sine) { return optional("phase_rad", number(sine.phase_rad, "rad", {-1e3, 1e3})); }

}  // namespace

void read_presliding(const Section& section, AxisWorld& world) {
  const Bristles bristles = config::read_presliding(section);
  world.plant.presliding = {.stiffness_N_per_m = bristles.stiffness_N_per_m,
                            .damping_Ns_per_m = bristles.damping_Ns_per_m};
}

void read_load(const Section& section, AxisWorld& world) {
  model::FlexibleLoad& load = world.plant.load.emplace();
  double lower_N = 0, upper_N = 0, seen_N_per_m = 0;  // the last is for the certificate
  model::ShapePtr shape = model::shape::constant(1);
  section.read({
      required("mass_kg", number(load.mass_kg, "kg", positive)),
      required("stiffness_N_per_m", number(load.coupling.stiffness_N_per_m, "N/m", spring)),
      optional("stiffness_seen_N_per_m", number(seen_N_per_m, "N/m", spring)),
      optional("damping_Ns_per_m", number(load.coupling.damping_Ns_per_m, "N s/m", damping)),
      optional("friction_lower_N", number(lower_N, "N", positive)),
      optional("friction_upper_N", number(upper_N, "N", positive)),
      optional("law", shape_value(shape)),
      optional("encoder", choice(world.encoder_on_load, {{"motor", false}, {"load", true}})),
  });
  require_load_friction(section, lower_N, upper_N);
  if (lower_N > 0) load.friction.emplace(model::FrictionBounds{lower_N, upper_N}, std::move(shape));
}

void read_backlash(const Section& section, AxisWorld& world) {
  section.read({required("gap_m", number(world.gap_m, "m", {0, 1}))});
}

void read_cogging(const Section& section, AxisWorld& world) {
  model::PositionSine& sine = world.plant.cogging;
  section.read({required("amplitude_N", number(sine.amplitude, "N", positive)), period(sine), phase(sine)});
}

void read_ripple(const Section& section, AxisWorld& world) {
  model::PositionSine& sine = world.plant.ripple;
  section.read({required("share", number(sine.amplitude, "", {0, 0.99, true})), period(sine), phase(sine)});
}

void read_encoder_error(const Section& section, AxisWorld& world) {
  model::EncoderErrorParameters& error = world.encoder_error.emplace();
  section.read({
      optional("noise_m", number(error.noise_m, "m", {0, 1})),
      optional("interpolation_m", number(error.interpolation.amplitude, "m", {0, 1})),
      optional("period_m", number(error.interpolation.period_m, "m", {1e-9, 1e6})),
      optional("seed", integer([&](std::int64_t n) { error.seed = static_cast<std::uint64_t>(n); }, 0, INT64_MAX)),
  });
  if (error.interpolation.amplitude != 0 && !section.has("period_m"))
    section.fail("period_m",
                 "is missing; the interpolation error repeats with the lines of the encoder: give their "
                 "distance");
}

void read_drift(const Section& section, AxisWorld& world) {
  model::FrictionDrift& drift = world.drift.emplace();
  section.read({
      required("share", number(drift.share, "", {0, 0.99, true})),
      required("period_s", number(drift.period_s, "s", {1e-2, 1e9})),
  });
}

}  // namespace breakaway::scenario
