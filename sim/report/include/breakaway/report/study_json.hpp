// Every run of a study, as text for other programs. SI units; names carry them.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/study/friction_study.hpp"

namespace breakaway::report {

struct StudiedAxis {
  std::string file;
  config::Node node;  // of a single axis
  std::vector<study::StudyRow> rows;
};

// Returns "PID" or "impulsive".
const char* controller_name(const config::Node& node);

std::string to_json(const std::vector<StudiedAxis>& axes, const study::StudyOptions& options);

}  // namespace breakaway::report
