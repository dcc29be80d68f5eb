// What a design found of a node, as text for other programs. SI units; names carry them.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/design/report.hpp"
#include "breakaway/stability/machine_certificate.hpp"

namespace breakaway::report {

// A report for each axis, as config::examine() makes them. Of several axes each has what a single one has at the top.
std::string to_json(const config::Node& node, const std::vector<design::DesignReport>& reports);

// Of axes that push each other, as config::examine_machine() certifies them.
std::string to_json(const config::Node& node, const stability::MachineCertificate& certificate);

}  // namespace breakaway::report
