// What the page's operator wants of an axis.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace breakaway::watch {

enum class Action : std::uint8_t { enable, stop, target, reset };

struct Command {
  std::size_t axis = 0;  // place in the node
  Action action = Action::stop;
  double target_m = 0;  // read with Action::target only
};

// Returns what the body of a request says, {"axis": place, "action": "target", "target_m": number} for example, if it
// says anything.
std::optional<Command> read_command(std::string_view body);

}  // namespace breakaway::watch
