// What a fuzzer claims: libFuzzer keeps an input whose run is aborted.
#pragma once

#include <cstdlib>
#include <string_view>

namespace breakaway::fuzz {

inline void require(bool condition) {
  if (!condition) std::abort();
}

// A refusal is one line that says why.
inline void require_one_line(std::string_view message) {
  require(!message.empty() && message.find('\n') == std::string_view::npos);
}

}  // namespace breakaway::fuzz
