// The axes of a node as controller/design examines them: what `breakaway design` shows and what a node asks of itself
// before it starts.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/design/report.hpp"

namespace breakaway::config {

// Throws InputError for a PID, and when no accuracy is asked for.
design::AxisDesign axis_design(const Node& node, const Axis& axis);

// Examines every axis, in the order of the file. Throws InputError as axis_design(), and when the axes do not fit the
// bus.
std::vector<design::DesignReport> examine(const Node& node);

// Says why one axis of the node is not certified: the first reason; nothing where it is.
std::string why_not_certified(const Node& node, const Axis& axis);

// Says what of the moves of an axis that starts there, to its target and to those that follow, is longer than its
// certificate is for; nothing where none is.
std::string outside_certified_moves(const Axis& axis, double start_m);

// Throws InputError with the axis and the first reason unless every axis is certified.
void require_certified(const Node& node, const std::vector<design::DesignReport>& reports);

}  // namespace breakaway::config
