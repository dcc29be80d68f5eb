// Shard: one part of a long computation whose pieces are numbered and depend on nothing but their number, so that many
// machines can share it.
#pragma once

#include <cstdint>

namespace breakaway::study {

// The pieces whose number has the same remainder by count as index has. Interleaved, so that what lies together and is
// slow is shared out evenly, too.
struct Shard {
  int index = 0;  // 0 is the same as count
  int count = 1;  // >= 1

  bool owns(std::int64_t number) const { return number % count == index % count; }
};

}  // namespace breakaway::study
