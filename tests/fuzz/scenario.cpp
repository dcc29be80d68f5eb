// Any text is either a scenario or refused with one line that says why; nothing else comes out of the reader.
#include <breakaway/input/input_error.hpp>
#include <breakaway/scenario/machine_scenario.hpp>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), count);
  try {
    breakaway::scenario::parse_any_scenario(text, "fuzz.toml");
  } catch (const breakaway::InputError& error) {
    const std::string_view message = error.what();
    if (message.empty() || message.find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
