// A look at TOML text before the parser sees it.
#pragma once

#include <optional>
#include <string_view>

namespace breakaway::scenario {

// The line, from 1, of the first character beyond ASCII that stands neither in a comment nor in a string of one line.
// No key of ours has one, and toml++ 3.3 runs into undefined behaviour on some of them (fixed upstream after 3.4).
inline std::optional<int> line_beyond_ascii(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  constexpr char none = 0;
  constexpr char comment = '#';
  int line = 1;
  char inside = none;  // or what it began with: comment, " or '
  for (std::size_t i = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') {
      ++line;
      inside = none;
    } else if (inside == none) {
      if (static_cast<unsigned char>(c) >= 0x80) return line;
      if (c == comment || c == '"' || c == '\'') inside = c;
    } else if (inside == '"' && c == '\\' && i + 1 < text.size() && text[i + 1] != '\n') {
      ++i;
    } else if (inside != comment && c == inside) {
      inside = none;
    }
  }
  return std::nullopt;
}

}  // namespace breakaway::scenario
