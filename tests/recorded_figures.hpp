// Figures of runs that were kept in a file, to see whether the same runs still give them. A line of the file is the
// name of a run and its figures, and the first line names those.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace breakaway::recorded {

class RecordedFigures {
 public:
  // digits: that the file holds of a figure.
  RecordedFigures(std::string path, int digits) : path_{std::move(path)}, digits_{digits} {
    std::ifstream file{path_};
    for (std::string line; std::getline(file, line);) {
      std::istringstream fields{line};
      std::string run;
      std::getline(fields, run, ',');
      for (std::string field; std::getline(fields, field, ',');) {
        if (run == "run")
          names_.push_back(field);
        else
          runs_[run].push_back(std::strtod(field.c_str(), nullptr));
      }
    }
  }

  // A failure says which figures are others, and what the line would be.
  void expect(const std::string& run, std::span<const double> now) const {
    const auto found = runs_.find(run);
    ASSERT_TRUE(found != runs_.end() && found->second.size() == now.size() && names_.size() == now.size())
        << path_ << " lacks: " << line_of(run, now);
    std::string others;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double recorded = found->second[i];
      if (!(std::fabs(now[i] - recorded) <= std::pow(10, 1 - digits_) * std::fabs(recorded))) others += ' ' + names_[i];
    }
    EXPECT_EQ(others, "") << path_ << " would hold: " << line_of(run, now);
  }

 private:
  std::string line_of(const std::string& run, std::span<const double> figures) const {
    std::string line = run;
    for (const double figure : figures) {
      std::array<char, 40> text{};
      std::snprintf(text.data(), text.size(), ",%.*g", digits_, figure == 0 ? 0.0 : figure);
      line += text.data();
    }
    return line;
  }

  std::string path_;
  int digits_;
  std::vector<std::string> names_;
  std::map<std::string, std::vector<double>> runs_;
};

}  // namespace breakaway::recorded
