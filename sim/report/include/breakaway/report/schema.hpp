// The schema of the files that breakaway reads, for editors that complete and check them.
#pragma once

#include <string>

#include "breakaway/config/known_tables.hpp"

namespace breakaway::report {

// JSON Schema, draft 2020-12, of the file that is "" in `known`. It names no key that the readers do not take, and
// leaves out none that they do. What a file says in several places at once, the readers alone judge.
std::string to_json_schema(const config::KnownTables& known);

}  // namespace breakaway::report
