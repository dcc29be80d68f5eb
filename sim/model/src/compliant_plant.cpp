#include "breakaway/model/compliant_plant.hpp"

#include <string>

#include "require.hpp"

namespace breakaway::model {
namespace {

void require_spring(double stiffness_N_per_m, double damping_Ns_per_m) {
  require_positive("stiffness_N_per_m", stiffness_N_per_m);
  require_not_negative("damping_Ns_per_m", damping_Ns_per_m);
}

}  // namespace

void require_valid(const PositionSine& sine) {
  require_not_negative("amplitude", sine.amplitude);
  require_positive("period_m", sine.period_m);
  require_finite("phase_rad", sine.phase_rad);
}

void require_valid(const Presliding& presliding) {
  require_spring(presliding.stiffness_N_per_m, presliding.damping_Ns_per_m);
}

void require_valid(const ElasticCoupling& coupling) {
  require_spring(coupling.stiffness_N_per_m, coupling.damping_Ns_per_m);
  require_not_negative("gap_m", coupling.gap_m);
}

void require_valid(const CompliantPlant& plant) {
  require_positive("mass_kg", plant.mass_kg);
  require_finite("force_N", plant.force_N);
  require_valid(plant.cogging);
  require_valid(plant.ripple);
  if (plant.ripple.amplitude >= 1)
    throw InputError{"share", "of the ripple is " + to_text(plant.ripple.amplitude) + "; give a number below 1"};
  if (plant.presliding) require_valid(*plant.presliding);
  if (!plant.load) return;
  require_positive("mass_kg", plant.load->mass_kg);
  require_valid(plant.load->coupling);
}

}  // namespace breakaway::model
