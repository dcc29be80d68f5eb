// read_node() reads nodes from TOML files.
//
// One file describes the node, and the world around it for simulation. The node's keys are read here. Those of the
// simulation are passed over, by name, so that a misspelt key is found whoever reads the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// These rows of another reader say what else may stand in the tables of an axis.
struct AxisRows {
  std::vector<Key> plant, friction, controller, drive;
};

// And these say what else may stand in the rest of the file.
struct FileRows {
  std::vector<Key> root, loop, bus, run;
  // Called once for each axis, from 0; what it gives is read before the next call.
  std::function<AxisRows(std::size_t place)> axis;
};

// Returns rows for every key that only the simulation reads; they accept anything.
FileRows passed_over();

// These throw InputError when the file cannot be read or is no TOML, when a key is unknown or missing, when a value is
// of the wrong type or outside its range, and when numbers of one axis or of two contradict one another. Keys, units
// and ranges stand with the readers in src, one row each.
Node read_node(const std::filesystem::path& file);
Node parse_node(std::string_view text, const std::string& name);

// Says whether the file describes axes, and not a [machine] alone.
bool has_axes(const toml::table& document);

// Reads a document that parse_toml() has parsed. `others` is read in the order of the file's tables, and `known`
// gathers what is read.
Node read_node(const toml::table& document, const std::string& name, const FileRows& others,
               KnownTables* known = nullptr);

// Throws InputError unless [plant.load] has both bounds of its friction, in order, or neither and no law of it.
void require_load_friction(const Section& load, double lower_N, double upper_N);

// [plant.presliding], for certificate and simulation. Throws InputError as read_node() does, and where the law of Dahl
// is asked for with damping, which it does not have.
Bristles read_presliding(const Section& presliding);

// Throws InputError with the figures, and the least period that would do, when the axes do not fit the bus. A node
// without [loop] or bus fits.
void require_fitting_bus(const Node& node);
// That a file may ask for, and in which the frames of the node and what they are late by fit its bus [s].
double least_period_s(const Node& node);

}  // namespace breakaway::config
