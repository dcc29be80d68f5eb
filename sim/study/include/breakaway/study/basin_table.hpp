// A basin as a table, x1,x2,attracted,time_s, x1 fastest: what is published, what shards are merged from and what an
// interrupted run goes on from. Above it stands a comment, of which system and grid it is. `attracted` is 1, 0 for
// lost, or -1 for undecided; time_s is when that was certain. Numbers are the shortest that read back to the same bits.
#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include "breakaway/study/basin.hpp"

namespace breakaway::study {

// The lines of the table in parts, for format::write_output. `basin` must outlive it and have no pending point.
std::function<std::string()> table_parts(const Basin& basin, const scenario::MachineScenario& scenario);

// Takes every point of the file that belongs to the basin; a last line without its end is left out. Throws
// InputError: not readable, not such a table, another first line than table_label(), and a point that is none of the
// grid, that is known otherwise, or that a certificate of the machine excludes.
void read_table(const std::string& path, const scenario::MachineScenario& scenario, Basin& basin);

// The first line, a comment that tells grids and systems apart: "# breakaway basin, 101 points ...".
std::string table_label(const Grid& grid, const scenario::MachineScenario& scenario);

// The rows that are done, on disk while the run goes on.
class Journal {
 public:
  // Reads what the file holds into the basin, if there is one, and continues it. Throws as read_table, and when the
  // file cannot be written.
  Journal(const std::string& path, const scenario::MachineScenario& scenario, Basin& basin);

  void append(const Basin& basin, int row);

 private:
  std::string path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

}  // namespace breakaway::study
