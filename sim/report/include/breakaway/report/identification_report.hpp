// What an experiment found of an axis, as a page with pictures and as JSON.
#pragma once

#include <string>

#include "breakaway/evaluation/identification.hpp"

namespace breakaway::report {

struct IdentifiedRun {
  std::string title;   // of the file, or its name
  std::string source;  // what was evaluated
  std::string ending;  // in words
  bool complete = false;
  evaluation::Record record;
  evaluation::Identification found;
};

// Throws InputError when gnuplot cannot be run.
std::string identification_html(const IdentifiedRun& run);

std::string identification_json(const IdentifiedRun& run);

}  // namespace breakaway::report
