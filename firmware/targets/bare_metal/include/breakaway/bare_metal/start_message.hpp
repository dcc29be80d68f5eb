// A debugger reads this of a node that does not run: a sentence, the axis that it is about, and what reset the
// processor.
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/firmware/flashed_node.hpp"

namespace breakaway::bare_metal {

inline constinit const char* volatile start_message = "not started: reset, or a fault before the start";
inline constinit volatile std::uint8_t start_axis = 0;
inline constinit const char* volatile reset_message = "not read";  // what reset the processor last

// `text` must be a literal, which has its zero behind it.
inline void tell(std::string_view text) noexcept { start_message = text.data(); }

inline void tell(const firmware::NodeVerdict& verdict) noexcept {
  tell(to_string(verdict.error));
  start_axis = verdict.axis;
}

}  // namespace breakaway::bare_metal
