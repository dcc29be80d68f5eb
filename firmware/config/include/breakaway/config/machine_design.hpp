// The machine that the axes of a node make together, as controller/stability certifies it: what `breakaway design`
// shows of a node with a [coupling], and what its coordinator is made from.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/flash.hpp"
#include "breakaway/config/node.hpp"
#include "breakaway/stability/machine_certificate.hpp"

namespace breakaway::config {

// These require node.coupling.
stability::CoupledAxes coupled_axes(const Node& node);
stability::SampledApproach sampled_approach(const Node& node);
Eigen::VectorXd tolerances_m(const Node& node);

// The certificate of Theorem U; its reason names the axis by its name in the file. What the theorem does not take in,
// as a bus that loses frames, is refused in the same way. Throws InputError for a machine that is none.
stability::MachineCertificate examine_machine(const Node& node);

// What a certificate promises, in a clause; and what it rests on, each in a clause.
std::string machine_promise(const Node& node, const stability::MachineCertificate& certificate);
std::vector<std::string> machine_conditions(const Node& node);

// The node as it is flashed, certified and under its checksum. Throws InputError with the reason where its machine is
// not certified, and what require_flashable() throws. Real: float or double.
template <class Real>
MachineNode<Real> flashed_machine(const Node& node, const stability::MachineCertificate& certificate);

// Throws InputError as well where firmware::verify() refuses the node.
MachineNode<float> certified_machine(const Node& node, const stability::MachineCertificate& certificate);

}  // namespace breakaway::config
