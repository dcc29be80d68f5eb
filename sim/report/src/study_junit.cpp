#include "breakaway/report/study_junit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace breakaway::report {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

struct Case {
  std::string name;
  double time_s = 0;
  std::string failure;  // empty where it passes
};

std::string text_of(const Case& c, const std::string& suite) {
  std::string text = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:g}\"", escaped(suite),
                                 escaped(c.name), c.time_s);
  if (c.failure.empty()) return text + "/>\n";
  return text + fmt::format(">\n      <failure message=\"{}\"/>\n    </testcase>\n", escaped(c.failure));
}

Case case_of(const study::StudyRun& run) {
  if (run.settled) return {run.law, run.settling_time_s, {}};
  const std::string fault = run.faults.empty() ? std::string{} : ", fault: " + run.faults.front().name;
  return {run.law, 0, fmt::format("not settled, final error {:.3g} m{}", run.final_error_m, fault)};
}

std::string suite_text(const std::string& name, const std::vector<Case>& cases) {
  const auto failures = std::ranges::count_if(cases, [](const Case& c) { return !c.failure.empty(); });
  std::string text =
      fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">\n", escaped(name), cases.size(), failures);
  for (const Case& c : cases) text += text_of(c, name);
  return text + "  </testsuite>\n";
}

}  // namespace

std::string to_junit(const std::vector<StudiedFile>& studies, const std::vector<study::Requirement>& requirements) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const StudiedFile& studied : studies) {
    const bool required = &studied == &studies.front();
    for (const study::StudyRow& row : studied.rows) {
      std::vector<Case> cases;
      for (const study::StudyRun& run : row.runs) cases.push_back(case_of(run));
      for (const study::Requirement& requirement : required ? requirements : std::vector<study::Requirement>{}) {
        const std::vector<std::string> why = broken({requirement}, row);
        cases.push_back({requirement.text, 0, why.empty() ? std::string{} : why.front()});
      }
      text += suite_text(
          fmt::format("{} from {:g} m, {:g} m/s", studied.file, row.start.position_m, row.start.velocity_m_s), cases);
    }
  }
  return text + "</testsuites>\n";
}

}  // namespace breakaway::report
