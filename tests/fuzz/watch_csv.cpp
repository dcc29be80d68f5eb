// Any file that is shown is read as a run, or refused with one line.
#include <breakaway/input/input_error.hpp>
#include <breakaway/watch/csv_reader.hpp>
#include <cmath>

#include "require.hpp"

namespace {

std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  std::string_view text(reinterpret_cast<const char*>(bytes), count);
  try {
    const breakaway::watch::CsvReader reader{next_line(text)};
    while (!text.empty()) {
      const auto sample = reader.read(next_line(text));
      breakaway::fuzz::require(std::isfinite(sample.time_s) && std::isfinite(sample.position_m));
    }
  } catch (const breakaway::InputError& error) {
    breakaway::fuzz::require_one_line(error.what());
  }
  return 0;
}
