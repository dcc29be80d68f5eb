// Text for a comment in generated code.
#pragma once

#include <algorithm>
#include <string>

namespace breakaway::config {

// A source file's name could end a comment by a line break, or in C by a slash behind an asterisk.
inline std::string in_one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\\' || c == '*'; }, '?');
  return text;
}

}  // namespace breakaway::config
