// The runs of a study as a table, a line a run: what the shards of a cluster write and are merged from. Numbers are
// written so that they are read back bit for bit.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "breakaway/study/friction_study.hpp"

namespace breakaway::study {

// The first line of a table, by which a table of another study is known: of another file (its text), axis, seed or
// number of laws.
std::string study_table_label(const std::string& file_text, const std::string& axis, const StudyOptions& options);

// The table in parts, for format::write_output; an empty one after the last. `rows` must outlive it.
std::function<std::string()> study_table_parts(const std::vector<StudyRow>& rows, const std::string& label);

// All rows of the options' starts, from the tables at these paths. Throws InputError with file and line for a table
// that cannot be read, is of another study or spoiled, for two that contradict one another, and for runs that are in
// none.
std::vector<StudyRow> merged_study(const std::vector<std::string>& paths, const std::string& label,
                                   const StudyOptions& options);

}  // namespace breakaway::study
