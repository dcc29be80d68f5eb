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

// Says why the certificate of an axis is not for a run that starts there, so fast: it is for axes that rest when they
// are enabled, and for moves up to a length; nothing where it is for that.
std::string outside_certificate(const Axis& axis, double start_m, double start_m_s);

// The speed that no kick from rest gives the axis more than, [m/s]; under the coast "pd" that of the largest impulse,
// tested.
double kick_peak_m_s(const Axis& axis, const design::DesignReport& report);

// Throws InputError with the axis and the first reason unless every axis is certified.
void require_certified(const Node& node, const std::vector<design::DesignReport>& reports);

}  // namespace breakaway::config
