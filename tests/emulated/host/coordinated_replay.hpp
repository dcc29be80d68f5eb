// Eight axes under their coordinator, in closed loop with a plant and on readings that no machine would give.
#pragma once

#include <string>

namespace breakaway::emulated {

// Records 10000 periods in closed loop, makes 20000 hostile ones, and replays both here: axis.tape, hostile.tape and
// their .results go into the folder. A tape has a step of every axis in each period, in their order. Under callgrind
// every period leaves its count, labelled coordinated/<results>/<phase in which it begins>.
void replay_coordinated_tapes(const std::string& folder);

}  // namespace breakaway::emulated
