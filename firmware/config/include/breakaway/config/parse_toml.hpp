// parse_toml() turns TOML text into a table, and keeps a flaw of the parser from doing harm.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "breakaway/config/toml.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {

constexpr bool beyond_ascii(char c) { return static_cast<unsigned char>(c) >= 0x80; }

// Throws InputError when a backslash, with or without white space behind it, comes before a character beyond ASCII.
inline void refuse_backslash_before_beyond_ascii(std::string_view text, std::string_view name) {
  for (auto at = text.find('\\'); at != text.npos; at = text.find('\\', at + 1)) {
    const auto next = text.find_first_not_of(" \t\r\n", at + 1);
    if (next == text.npos || !beyond_ascii(text[next])) continue;
    const auto line = 1 + std::ranges::count(text.substr(0, next), '\n');
    throw InputError{fmt::format(
        "{}:{}: a character beyond ASCII comes after a backslash; drop the backslash or write it as \\uXXXX", name,
        line)};
  }
}

// Throws InputError when a key or a header has more than `most_key_parts` parts, a.b.c of three.
inline constexpr std::size_t most_key_parts = 32;
void refuse_deep_keys(std::string_view text, std::string_view name);

// A text in UTF-16, as PowerShell's > writes it, would be refused at a character that nobody sees.
inline void refuse_utf_16(std::string_view text, std::string_view name) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw InputError{fmt::format("{}:1: is in UTF-16, and TOML is in UTF-8; save it as UTF-8", name)};
}

// Does what toml::parse does, after a byte order mark if there is one. Throws toml::parse_error and InputError.
//
// toml++ makes a table of every part of a key, one in the other, and calls itself for each of them when it looks at
// them or forgets them: a long key has no room on the stack. It limits the depth of what stands in brackets itself.
//
// toml++ 3.3 runs into undefined behaviour on some characters beyond ASCII where white space may stand (fixed upstream
// after 3.4). A text that has any is therefore parsed with question marks in their place first: neither keys nor
// numbers nor spaces are made of those, so in what passes they stand in strings and comments only. In a string of
// several lines white space may stand behind a backslash, too, which the first parse cannot tell.
inline toml::table parse_toml(std::string_view text, std::string_view name) {
  refuse_utf_16(text, name);
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  refuse_deep_keys(text, name);
  if (std::ranges::any_of(text, beyond_ascii)) {
    refuse_backslash_before_beyond_ascii(text, name);
    std::string masked{text};
    std::ranges::replace_if(masked, beyond_ascii, '?');
    static_cast<void>(toml::parse(masked));
  }
  return toml::parse(text);
}

// Returns use(document) for the document that the text is. Throws InputError for a text that is none.
template <class Use>
auto with_document(std::string_view text, const std::string& name, Use use) {
  try {
    return use(parse_toml(text, name));
  } catch (const toml::parse_error& error) {
    const bool encoding = error.description().find("utf-8") != std::string_view::npos;
    throw InputError{fmt::format("{}:{}: not valid TOML: {}{}", name, error.source().begin.line, error.description(),
                                 encoding ? "; save the file as UTF-8" : "")};
  }
}

}  // namespace breakaway::config
