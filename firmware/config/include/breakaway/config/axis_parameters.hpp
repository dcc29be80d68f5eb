// These functions turn a node's description into the parameters of the control law, in the scalar type that it computes
// in.
#pragma once

#include <string>

#include "breakaway/config/node.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/pid_controller.hpp"

namespace breakaway::config {

// Returns the most that the drive is asked for, which is what the file allows and what the drive can give.
double max_force_N(const Axis& axis);
// The step in which the drive of the axis can be commanded force. Requires axis.drive.
double force_step_N(const Axis& axis);
// The drive gives force in steps; of what the law may ask for, it gives the whole steps.
double granted_N(const Axis& axis, double force_N);
// What of the most is given against a known force on the axis, in whole steps of the drive, and what that leaves the
// law.
double feedforward_N(const Axis& axis);
double law_force_N(const Axis& axis);

// By how much the answer of the drive to a SYNC comes later than the frames of a period take at their longest.
double answer_delay_s(const Node& node, const Axis& axis);

// A target is a whole count for the loop: the one of the file that is furthest from a count, and that count's place.
struct OffCount {
  double target_m, count_at_m;
  double m() const { return std::abs(target_m - count_at_m); }
};
OffCount furthest_off_count(const Axis& axis);

// Requires axis.controller.impulsive. Real: float or double.
template <class Real>
law::AxisParameters<Real> axis_parameters(const Node& node, const Axis& axis);

// The axes that kicks under the coast "brake" are made for: what the file says, as far off as it admits. Requires
// axis.controller.impulsive and axis.drive.
design::BrakedClass braked_class(const Node& node, const Axis& axis);

// What is true of the axis with the load that hangs on it, if one does.
double mass_of_all_kg(const Axis& axis);
law::FrictionBounds<double> friction_of_all(const Axis& axis);

// Requires axis.controller.pid and axis.drive.
template <class Real>
law::PidParameters<Real> pid_parameters(const Node& node, const Axis& axis);

// Whether the counts of a position, or between two positions, fit the 32 bits of drive and loop. Beyond them a reading
// wraps, and an axis stands 2^32 counts off without a fault. Without a drive nothing is counted.
bool is_counted(double distance_m, const Axis& axis);
double counted_m(const Axis& axis);  // below which distances are

// Says why the axis cannot have its target there; nothing when it can.
std::string target_problem(double position_m, const Axis& axis);

// Says why the axis, which rests there, cannot have its target there, because the certificate of axes that push each
// other is of targets that are near; nothing when it can.
std::string way_problem(const Node& node, const Axis& axis, double from_m, double to_m);

}  // namespace breakaway::config
