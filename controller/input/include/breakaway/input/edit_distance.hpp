// How far a misspelt word is from a valid one.
#pragma once

#include <cstddef>
#include <string_view>

namespace breakaway {

// Levenshtein's distance: insertions, deletions and replacements from one word to the other.
std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace breakaway
