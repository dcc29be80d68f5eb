// The axes of a node as seen on its CAN bus, and, on request, commanded there.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "breakaway/watch/command.hpp"
#include "breakaway/watch/history.hpp"
#include "breakaway/watch/source.hpp"

namespace breakaway::watch {

// Any thread may call it.
class BusSource : public Source {
 public:
  // Takes what the operator wants. Returns nothing, or why it is not done. Requires `control` below.
  virtual std::string obey(const Command& command) = 0;

  // The names of the axes in the order of the node, as they stand in samples.
  virtual std::vector<std::string> axes() const = 0;

  // The page that commands is there. While it is not, the axes are told to stop.
  virtual void page_is_seen() = 0;
};

// Listens on the interface to the node that the file describes; unless `control`, it sends nothing. Throws InputError:
// the interface cannot be opened, or the file is not that of a node with drives.
std::unique_ptr<BusSource> watch_bus(const std::string& interface, const std::string& node_file, bool control,
                                     History& history);

}  // namespace breakaway::watch
