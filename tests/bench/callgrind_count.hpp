// Instruction counts of single calls. Under `valgrind --tool=callgrind --combine-dumps=yes` every counted call leaves
// one total in the output file, with its label; callgrind_counts.py reads them. Elsewhere a counted call is a plain
// call.
#pragma once

#include <valgrind/callgrind.h>

#include <string>

namespace breakaway::bench {

// The label of an empty call, whose count is that of the counting itself: everyone else's is taken less it.
inline constexpr const char* empty_label = "empty";

// One function for all calls, so that what counting adds is the same for all.
[[gnu::noinline]] inline void count_call(const char* label, void (*call)(void*), void* context) {
  CALLGRIND_ZERO_STATS;
  call(context);
  CALLGRIND_DUMP_STATS_AT(label);
}

template <class Call>
void count(const std::string& label, Call&& call) {
  count_call(
      label.c_str(), [](void* context) { (*static_cast<std::remove_reference_t<Call>*>(context))(); }, &call);
}

inline void start_counting() {
  CALLGRIND_START_INSTRUMENTATION;
  count(empty_label, [] {});
}
inline void stop_counting() { CALLGRIND_STOP_INSTRUMENTATION; }
inline bool can_count() { return RUNNING_ON_VALGRIND != 0; }

}  // namespace breakaway::bench
