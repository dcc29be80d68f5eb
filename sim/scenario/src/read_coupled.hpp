// A [machine] that stands behind the drives of several axes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/config/toml_section.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

// [machine], whose friction must be constant, and [start].
stability::LinearMachine<> read_coupled_machine(const config::Section& section);
stability::MachineState<Eigen::Dynamic> read_start(const config::Section& section, Eigen::Index coordinates,
                                                   config::Range range = {});

// What an axis' drive pushes, or its encoder reads.
struct PushedOrRead {
  std::int64_t coordinate = 0;  // from 1; 0: `row` is given
  std::vector<double> row;      // a share for each coordinate
};

struct PlaceInFile {
  PushedOrRead push;
  std::optional<PushedOrRead> read;  // none: what is pushed
};

// [plant.machine] of an axis.
void read_place(const config::Section& section, PlaceInFile& place);

// The same with its sizes, once the machine is known. `axis` names the axis in errors.
MachinePlace place_in(const CoupledMachine& machine, const PlaceInFile& place, const std::string& axis);

// Throws InputError unless the scenario's machine is one of those that its node is told of in [coupling], and each axis
// pushes and reads the coordinate of its own number. Nothing where there is no [coupling].
void require_told(const Scenario& scenario);

}  // namespace breakaway::scenario
