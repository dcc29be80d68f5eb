#include "breakaway/input/shell_word.hpp"

#include <algorithm>

namespace breakaway {
namespace {

// A byte beyond ASCII is part of a letter in every encoding that a shell knows.
bool plain(char c) {
  constexpr std::string_view marks = "_-./,:@%+=";
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || marks.find(c) != marks.npos ||
         static_cast<unsigned char>(c) >= 0x80;
}

}  // namespace

std::string shell_word(std::string_view text) {
  if (!text.empty() && std::ranges::all_of(text, plain)) return std::string{text};
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

}  // namespace breakaway
