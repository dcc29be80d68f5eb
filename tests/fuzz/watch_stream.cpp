// Any datagram is a sample or is refused with one line, and whoever sends them does not fill the memory with names.
#include <breakaway/input/input_error.hpp>
#include <breakaway/watch/datagram.hpp>
#include <breakaway/watch/history.hpp>
#include <cmath>

#include "require.hpp"

using breakaway::fuzz::require;

// A line is a datagram.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  std::string_view text(reinterpret_cast<const char*>(bytes), count);
  breakaway::watch::History history{16};
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    try {
      const auto read = breakaway::watch::read_datagram(text.substr(0, end));
      require(std::isfinite(read.sample.time_s) && std::isfinite(read.sample.position_m));
      history.add(read.sample);
    } catch (const breakaway::InputError& error) {
      breakaway::fuzz::require_one_line(error.what());
      history.complain(error.what());
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const auto excerpt = history.read(0, 16);
  require(excerpt.samples.size() <= 16 && excerpt.axes.size() <= breakaway::watch::History::most_axes);
  return 0;
}
