// The figures of a basin as text for other programs. SI units; names carry them.
#pragma once

#include <cstddef>
#include <string>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/study/basin.hpp"

namespace breakaway::report {

// What it took; nothing where tables were joined.
struct BasinEffort {
  std::size_t trajectories = 0;
  double seconds = 0;
};

std::string to_json(const scenario::MachineScenario& scenario, const study::Basin& basin,
                    const sil::Certificates& certificates, const BasinEffort& simulated);

}  // namespace breakaway::report
