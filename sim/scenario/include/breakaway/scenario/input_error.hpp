// InputError: what the user gave cannot be used. Its text is one line that names the place and the remedy.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace breakaway::scenario {

class InputError : public std::runtime_error {
 public:
  // Control characters become spaces: a parser's message or a quoted key may hold line breaks.
  explicit InputError(std::string text) : std::runtime_error(one_line(std::move(text))) {}

 private:
  static std::string one_line(std::string text) {
    constexpr auto control = [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; };
    std::ranges::replace_if(text, control, ' ');
    return text;
  }
};

}  // namespace breakaway::scenario
