// Reads the runs that `breakaway-node --csv` and `breakaway simulate --csv` write, a line a sample, by the names in
// their first line. Columns that it does not know are passed over.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "breakaway/watch/sample.hpp"

namespace breakaway::watch {

class CsvReader {
 public:
  // `header`: the file's first line, which may begin with a byte order mark. Throws InputError: it is not that of a
  // run, or names a column twice.
  explicit CsvReader(std::string_view header);

  // Throws InputError: the line does not fit the header. The text says what is wrong with it.
  Sample read(std::string_view line) const;

 private:
  std::vector<std::string> columns_;
};

}  // namespace breakaway::watch
