// The files of the page, which CMake has put into the program: see page/.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace breakaway::watch {

struct PageFile {
  const char* type;
  std::string_view content;
};

// By their paths in an address.
std::map<std::string, PageFile> page_files();

}  // namespace breakaway::watch
