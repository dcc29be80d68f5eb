// What limits an axis, whatever its gains.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tune_search.hpp"
#include "tuned_axis.hpp"

namespace breakaway::study {

// A number of the axis, so many times better than the file has it.
struct Improvement {
  std::string name;
  std::string key;  // that stands for it in a sentence
  double before = 0, after = 0;
  std::vector<config::Setting> settings;
};

// Every number of the axis that a better machine could better, by this factor >= 1.
std::vector<Improvement> improvements(const TunedAxis& axis, double factor);

// A sentence that names the number of the axis which forbids that it is certified, and a value that would do: that of
// the number which has to change least. Without one where no number alone is enough.
std::string remedy(const TunedAxis& axis, const TuneOptions& options);

}  // namespace breakaway::study
