// Where samples come from: a thread of its own that fills a History.
#pragma once

#include <memory>
#include <string>

#include "breakaway/watch/history.hpp"

namespace breakaway::watch {

// It fills the history from its construction on until its end.
class Source {
 public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  // What is watched, for the reader of the page.
  virtual std::string description() const = 0;
};

// A run that breakaway-node or `breakaway simulate` wrote with --csv, or still writes: lines that come later are read
// as they come. "-" is standard input, whose first line may come later. A line that cannot be read counts as malformed.
// Throws InputError: there is no such file, or it is no run.
std::unique_ptr<Source> follow_file(const std::string& path, History& history);

// What comes from `breakaway-node --stream udp:HOST:PORT`. `place`: PORT, for this machine's own node, or ADDRESS:PORT
// with one of this machine's addresses, or 0.0.0.0 or [::] for all of them. Port 0 is any free one; the description
// tells which. Throws InputError: the text is no such place, or the port is taken.
std::unique_ptr<Source> receive_stream(const std::string& place, History& history);

}  // namespace breakaway::watch
