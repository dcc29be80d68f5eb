// Which files a command reads, and which it writes.
#pragma once

#include <string>
#include <vector>

namespace breakaway {

// A file that was given to a command.
struct NamedFile {
  std::string option;  // by which it was given, as "--json"
  std::string path;    // empty: it was not given; "-" is standard input or output
};

// Says whether two paths lead to the same file, through links, or would once it is written.
bool same_file(const std::string& a, const std::string& b);

// Throws InputError, naming path and option, if a file of `written` is one of `read` or another one of `written`, or if
// two of `read` are standard input. A device or pipe may be read and written.
void require_apart(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written);

}  // namespace breakaway
