// History: the newest samples of a run, and what went wrong on their way. One thread adds, others read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "breakaway/watch/sample.hpp"

namespace breakaway::watch {

struct Losses {
  std::uint64_t malformed = 0;   // lines, datagrams or frames that could not be read
  std::uint64_t on_the_way = 0;  // datagrams whose number is missing
  std::uint64_t at_sender = 0;   // samples that the node did not send
  std::string complaint;         // what was wrong with the newest that was malformed; empty: nothing yet
};

// Some samples in the order in which they came. The first one is number `next - samples.size()`.
struct Excerpt {
  std::vector<Sample> samples;
  std::uint64_t next = 0;  // to ask for in order to get what follows
  bool more = false;       // there are younger ones already
  std::vector<std::string> axes;
  Losses losses;
};

class History {
 public:
  static constexpr std::size_t most_axes = 64;

  // Keeps the newest `most` samples.
  explicit History(std::size_t most = 500'000) : most_{most} {}

  // An axis that is one too many counts as malformed, for whoever invents names must not fill the memory.
  void add(Sample sample);

  // Counts what could not be read, and keeps why.
  void complain(std::string why);

  void set_lost_at_sender(std::uint64_t samples);
  void add_lost_on_the_way(std::uint64_t samples);

  // Returns at most `most` samples, from number `from` on or from the oldest that is still there.
  Excerpt read(std::uint64_t from, std::size_t most) const;

  Losses losses() const;

 private:
  mutable std::mutex mutex_;
  std::size_t most_;
  std::deque<Sample> samples_;
  std::uint64_t added_ = 0;
  std::vector<std::string> axes_;
  Losses losses_;
};

}  // namespace breakaway::watch
