// Output files that are there completely or not at all.
#pragma once

#include <string>
#include <string_view>

namespace breakaway::report {

// Writes `text` to the file `path`; "-" is standard output. A regular file is written beside its place and renamed when
// it is complete. Throws scenario::InputError naming the path and the reason.
void write_output(const std::string& path, std::string_view text);

}  // namespace breakaway::report
