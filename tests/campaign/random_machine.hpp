// Random machines over the whole range that the tools accept, family by family. A number gives the same machine on
// every computer: only the generator of the standard library is used, none of its distributions, and no function whose
// rounding is a library's own choice.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::campaign {

enum class Family {
  ordinary,          // 1 to 6 coordinates, 1 to 6 directions, everything of the size of one
  redundant,         // directions that depend on one another exactly
  switched_off,      // some of them without friction
  nearly_parallel,   // two directions 1e-3 to 1e-12 apart
  friction_ratio,    // friction from 1e-12 to 1
  stiff_damping,     // damping to 1e12
  stiff_springs,     // stiffness to 1e12
  defective,         // Jordan blocks
  non_normal,        // coupling in one direction, far larger than what returns
  light_mass,        // masses from 1e-12 to 1
  negative_damping,  // grows without friction
  ties,              // equal parts, whole numbers: everything happens at once
  on_boundary,       // starts where static friction is at its very limit
  overdamped,        // comes to rest without a stop
  mirrored,          // two equal halves, coupled
  constant_force,    // gravity, with springs that may be absent
  gyroscopic,        // skew damping
  circulatory,       // a stiffness that is not symmetric
  many               // 7 to 12 coordinates, up to 16 directions
};
inline constexpr int families = 19;

std::string_view to_string(Family family);

struct RandomMachine {
  std::int64_t number;
  Family family;
  stability::LinearMachine<> machine;
  stability::MachineState<Eigen::Dynamic> start;
  double end_s;
};

// The machine of this number, whose family is number % families.
RandomMachine random_machine(std::int64_t number);

// The machine as a scene for `breakaway simulate`.
std::string to_scene(const RandomMachine& random);

}  // namespace breakaway::campaign
