#include "breakaway/study/attraction.hpp"

namespace breakaway::study {
namespace {

std::vector<SweepRow> swept(const scenario::MachineScenario& s) {
  std::vector<SweepRow> rows;
  if (!s.sweep) return rows;
  stability::LinearMachine<> system = s.machine;
  for (const double d1 : s.sweep->d1) {
    system.damping = s.sweep->damping + d1 * s.sweep->per_d1;
    rows.push_back({d1, stability::certify_attractivity(system)});
  }
  return rows;
}

}  // namespace

Attraction find_attraction(const scenario::MachineScenario& s, const AttractionOptions& options) {
  Attraction found{sil::certify(s.machine),
                   stability::EquilibriumSet::make(s.machine),
                   stability::closed_form_rho_J(s.machine),
                   swept(s),
                   {}};
  if (found.attractivity().level_J == 0) return found;
  const double half_width =
      options.half_width > 0 ? options.half_width : fitting_half_width(s.machine, found.attractivity(), options.plane);
  found.region = certify_region(s, found.certificates, {half_width, options.plane, options.depth}, options.threads,
                                options.progress);
  return found;
}

}  // namespace breakaway::study
