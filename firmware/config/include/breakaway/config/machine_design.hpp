// The machine that the axes of a node make together, as controller/stability certifies it: what `breakaway design`
// shows of a node with a [coupling], and what its coordinator is made from.
#pragma once

#include <string>

#include "breakaway/config/flash.hpp"
#include "breakaway/config/node.hpp"
#include "breakaway/law/kick_coordinator.hpp"
#include "breakaway/stability/machine_certificate.hpp"

namespace breakaway::config {

// These require node.coupling.
stability::CoupledAxes coupled_axes(const Node& node);
stability::SampledApproach sampled_approach(const Node& node);
Eigen::VectorXd tolerances_m(const Node& node);

// The certificate of Theorem U; its reason names the axis by its name in the file. What the theorem does not take in,
// as a bus that loses frames, is refused in the same way. Throws InputError for a machine that is none.
stability::MachineCertificate examine_machine(const Node& node);

// The numbers of a certified machine. Throws InputError with the reason where it is not certified.
template <class Real>
law::CoordinatorParameters<Real, most_axes> coordinator_parameters(const Node& node);

}  // namespace breakaway::config
