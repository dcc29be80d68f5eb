// Reads tests/reference/impulsive_example.csv.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace breakaway::tests {

struct ReferenceKick {
  double time_s;
  double position_m;
  double velocity_after_m_s;
};

struct ReferenceExample {
  std::map<std::string, double> values;  // t1_s, t2_s, y2_m, t_inf_s, bound_s
  std::vector<ReferenceKick> kicks;
};

inline ReferenceExample read_reference_example() {
  std::ifstream file(BREAKAWAY_SOURCE_DIR "/tests/reference/impulsive_example.csv");
  ReferenceExample example;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream cells(line);
    std::string name;
    std::getline(cells, name, ',');
    std::vector<double> numbers;
    for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
    if (name == "kick") {
      example.kicks.push_back({numbers.at(0), numbers.at(1), numbers.at(2)});
    } else {
      example.values[name] = numbers.at(0);
    }
  }
  if (example.kicks.empty()) throw std::runtime_error("the reference of the worked example cannot be read");
  return example;
}

}  // namespace breakaway::tests
