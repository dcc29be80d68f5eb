// The tables of an axis in a node's file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// Heartbeats count milliseconds in 16 bits (1016h and 1017h). A drive is set up once one was heard, and has 10 s for
// that.
inline constexpr Range heartbeat{1e-3, 5};
inline constexpr Range heartbeat_timeout{1e-3, 65.535};
inline constexpr Range anywhere{-1e9, 1e9};
inline constexpr Range up_to_a_second{0, 1};

// The tables of one axis: the whole file, or an entry of [[axis]].
class AxisTables {
 public:
  // Keeps each table that is there for read().
  std::vector<Key> rows();

  // Reads the next axis of the node. Throws InputError; `parent`: where the tables stand.
  Axis read(const Section& parent, std::string name, const Node& node, const FileRows& others) const;

 private:
  // What the tables say that only a certificate must know.
  void look_around(Surroundings& surroundings) const;

  std::optional<Section> plant_, friction_, controller_, drive_, limits_, told_, uncertainty_, move_;
};

}  // namespace breakaway::config
