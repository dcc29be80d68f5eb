// A study as JUnit's XML, which servers of continuous integration read: each friction law of each start is a test case,
// and each requirement is one.
#pragma once

#include <string>
#include <vector>

#include "breakaway/study/friction_study.hpp"
#include "breakaway/study/requirement.hpp"

namespace breakaway::report {

struct StudiedFile {
  std::string file;
  std::vector<study::StudyRow> rows;
};

// A run that did not settle is a failure, and so is a requirement that a row of the first file does not keep. The time
// of a case is the simulated one of its settling.
std::string to_junit(const std::vector<StudiedFile>& studies, const std::vector<study::Requirement>& requirements);

}  // namespace breakaway::report
