// Output files that are there completely or not at all.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace breakaway::format {

// Writes `text` to the file `path`; "-" is standard output. A regular file is written beside its place and renamed when
// it is complete. Throws InputError naming the path and the reason.
void write_output(const std::string& path, std::string_view text);

// Writes a text in parts, of which only one is in memory at a time: `next` gives them in order, and an empty one after
// the last.
void write_output(const std::string& path, const std::function<std::string()>& next);

}  // namespace breakaway::format
