// What may stand in a scenario's file, as its readers say it.
#pragma once

#include "breakaway/config/known_tables.hpp"

namespace breakaway::scenario {

// Every table of the files that read_any_scenario() reads, and every key of each. The readers themselves are asked:
// they read files that together have every table, and say what else they would have taken there.
config::KnownTables known_tables();

}  // namespace breakaway::scenario
