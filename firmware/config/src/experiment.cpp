#include "breakaway/config/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

void require_described(const Node& node, const Axis& axis, const ExperimentRequest& request) {
  const auto missing = [&](const std::string& what) {
    throw InputError{what + " is missing: an experiment must know it"}.in_file(node.file);
  };
  if (node.coupling)
    throw InputError{"an experiment identifies an axis that moves alone, and these push each other: see [coupling]"}
        .in_file(node.file);
  if (!node.loop) missing("[loop] period_s");
  if (!axis.drive) missing("[drive]");
  if (axis.surroundings.load && axis.surroundings.load->encoder_on_load)
    throw InputError{
        "[plant.load] encoder = \"load\": an experiment finds a load on a spring by the swings of its motor; read the "
        "motor's encoder for it"}
        .in_file(node.file);
  const bool ends_below = std::isfinite(axis.limits.position_min_m) || std::isfinite(request.lowest_m);
  const bool ends_above = std::isfinite(axis.limits.position_max_m) || std::isfinite(request.highest_m);
  if (!ends_below || !ends_above) missing("[limits] position_m, the travel,");
  if (!std::isfinite(axis.limits.speed_m_s)) missing("[limits] speed_m_s");
}

// Beyond the file's limits the supervisor would end the experiment.
void require_inside(const Limits& limits, const ExperimentRequest& request) {
  const auto require = [](bool within, double asked_m, const char* end, double limit_m) {
    if (within || !std::isfinite(asked_m)) return;
    throw InputError{fmt::format(
        "the travel that is asked for ends at {:g} m, beyond the {} end of [limits], {:g} m: ask for less, or widen it",
        asked_m, end, limit_m)};
  };
  require(request.lowest_m >= limits.position_min_m, request.lowest_m, "lower", limits.position_min_m);
  require(request.highest_m <= limits.position_max_m, request.highest_m, "upper", limits.position_max_m);
}

}  // namespace

template <class Real>
identify::ExperimentParameters<Real> experiment_parameters(const Node& node, const Axis& axis,
                                                           const ExperimentRequest& request) {
  require_described(node, axis, request);
  constexpr double least_s = 2, most_s = 3600;  // the last second is for the axis to stop
  if (!(request.duration_s >= least_s && request.duration_s <= most_s))
    throw InputError{fmt::format("--duration {:g}: an experiment takes {:g} to {:g} s, and 60 s are usually enough",
                                 request.duration_s, least_s, most_s)};
  require_inside(axis.limits, request);
  const double lowest_m = std::max(request.lowest_m, axis.limits.position_min_m);
  const double highest_m = std::min(request.highest_m, axis.limits.position_max_m);
  if (!(lowest_m < highest_m))
    throw InputError{fmt::format("the travel from {:g} to {:g} m is empty: the lower end must be below the upper one",
                                 lowest_m, highest_m)};
  return {.period_s = static_cast<Real>(node.period_s()),
          .encoder_resolution_m = static_cast<Real>(axis.drive->encoder_resolution_m),
          .force_step_N = static_cast<Real>(force_step_N(axis)),
          .max_force_N = static_cast<Real>(std::min(max_force_N(axis), request.max_force_N)),
          .lowest_m = static_cast<Real>(lowest_m),
          .highest_m = static_cast<Real>(highest_m),
          .max_speed_m_s = static_cast<Real>(axis.limits.speed_m_s),
          .duration_s = static_cast<Real>(request.duration_s),
          .load_on_spring = axis.surroundings.load.has_value()};
}

template identify::ExperimentParameters<float> experiment_parameters<float>(const Node&, const Axis&,
                                                                            const ExperimentRequest&);
template identify::ExperimentParameters<double> experiment_parameters<double>(const Node&, const Axis&,
                                                                              const ExperimentRequest&);

}  // namespace breakaway::config
