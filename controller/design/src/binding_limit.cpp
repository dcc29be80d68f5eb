#include "breakaway/design/binding_limit.hpp"

#include <array>

namespace breakaway::design {
namespace {

struct Limit {
  std::string_view name;
  void (*halve)(BrakedClass&);
};

void halve(double& least, double& most) {
  const double quarter = (most - least) / 4;
  least += quarter;
  most -= quarter;
}
void halve(Interval& interval) { halve(interval.least, interval.most); }

constexpr std::array limits{
    Limit{"the encoder",
          [](BrakedClass& c) {
            c.encoder_resolution_m /= 2;
            c.encoder_noise_m /= 2;
            c.rounding_m /= 2;
          }},
    Limit{"the step of force", [](BrakedClass& c) { c.force_step_N /= 2; }},
    Limit{"the time constant of the current loop",
          [](BrakedClass& c) {
            c.lag_s.least /= 2;
            c.lag_s.most /= 2;
          }},
    Limit{"the jitter of the loop", [](BrakedClass& c) { c.jitter_s /= 2; }},
    Limit{"the force beside the drive's", [](BrakedClass& c) { c.load_N /= 2; }},
    Limit{"what is not known of mass, force gain and time constant",
          [](BrakedClass& c) {
            halve(c.mass_kg);
            halve(c.force_gain);
            halve(c.lag_s);
          }},
    Limit{"the width of the friction bounds", [](BrakedClass& c) { halve(c.friction.lower_N, c.friction.upper_N); }},
};

}  // namespace

BindingLimit binding_limit(const BrakedClass& axes) {
  BindingLimit binding{"nothing that can be halved", design_braked_kicks<float>(axes).least_tolerance_m};
  for (const Limit& limit : limits) {
    BrakedClass c = axes;
    limit.halve(c);
    const auto design = design_braked_kicks<float>(c);
    if (design.possible() && design.least_tolerance_m < binding.least_tolerance_m)
      binding = {limit.name, design.least_tolerance_m};
  }
  return binding;
}

}  // namespace breakaway::design
