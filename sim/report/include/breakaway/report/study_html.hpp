// The report of a study: how long the runs took and how exactly they ended, over all friction laws, and the worst of
// them.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/sil/result.hpp"
#include "breakaway/study/friction_study.hpp"

namespace breakaway::report {

// The runs from one start, and the one under the worst law once more.
struct ReportedRow {
  study::StudyRow row;
  sil::Result worst;  // with its trace
  std::string again;  // the command that runs it
};

struct ReportedStudy {
  std::string file;
  config::Node node;  // of a single axis
  std::vector<ReportedRow> rows;
};

// One HTML page. Throws InputError when gnuplot, which draws, cannot be run.
std::string study_html(const std::vector<ReportedStudy>& studies);

}  // namespace breakaway::report
