// The pictures of the report.
#pragma once

#include <string>
#include <vector>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::report {

struct Picture {
  std::string title;
  std::string caption;
  std::string svg;
};

// Those for which the result holds something to see.
std::vector<Picture> draw_pictures(const scenario::Scenario& scenario, const sil::Result& result);

}  // namespace breakaway::report
