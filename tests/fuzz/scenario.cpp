// Any text is either a scenario or refused with one line that says why; nothing else comes out of the reader.
#include <breakaway/input/input_error.hpp>
#include <breakaway/scenario/machine_scenario.hpp>

#include "require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), count);
  try {
    breakaway::scenario::parse_any_scenario(text, "fuzz.toml");
  } catch (const breakaway::InputError& error) {
    breakaway::fuzz::require_one_line(error.what());
  }
  return 0;
}
