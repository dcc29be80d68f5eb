// What a study is required to show, for a script that goes on only if it does.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "breakaway/study/friction_study.hpp"

namespace breakaway::study {

// A quantity of a row, and its bound: "worst_settling_s<=0.5".
struct Requirement {
  std::string text;  // as it was given
  double (*quantity)(const StudyRow&) = nullptr;
  bool at_least = false;  // otherwise at most
  double bound = 0;

  // A value that is not a number keeps no bound.
  bool holds(const StudyRow& row) const;
};

// Throws InputError, which names the quantities that there are, for a text that is not QUANTITY<=NUMBER or
// QUANTITY>=NUMBER.
Requirement read_requirement(std::string_view text);

// A sentence for each requirement that a row does not keep, with its value and the bound.
std::vector<std::string> broken(const std::vector<Requirement>& requirements, const StudyRow& row);

}  // namespace breakaway::study
