// What an experiment found of an axis, entered into the file of its node.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace breakaway::config {

// A load on a spring. Friction with its margin.
struct IdentifiedSpring {
  double motor_kg = 0, load_kg = 0;
  double stiffness_N_per_m = 0, least_seen_N_per_m = 0;  // with its margin, and without
  double damping_Ns_per_m = 0;                           // at least
  double motor_lower_N = 0, motor_upper_N = 0;
  double load_lower_N = 0, load_upper_N = 0;
};

struct IdentifiedAxis {
  double mass_kg = 0, mass_uncertainty = 0;           // relative, either way
  double friction_lower_N = 0, friction_upper_N = 0;  // with their margin
  std::optional<double> lag_s{};                      // of the current loop, where it could be seen
  double lag_uncertainty = 0;                         // relative, either way
  std::optional<double> presliding_stiffness_N_per_m{};
  std::optional<IdentifiedSpring> spring{};  // mass and friction above are then those of both together
};

// Returns the text with these numbers as what the node is told of the axis: in [plant] and [friction], or in [told]
// where the file has that table; with a load on a spring in [plant], [friction] and [plant.load], which the file must
// have, and what they come to in [told]. Gains of the impulsive law go with the mass, so that their damping ratios
// stay. Everything else stands as it was. `axis` is its name; of a file with one axis it is not read. Throws InputError
// as read_node() does where the result is no node's file.
std::string with_identified(std::string_view text, const std::string& file, const std::string& axis,
                            const IdentifiedAxis& found);

}  // namespace breakaway::config
