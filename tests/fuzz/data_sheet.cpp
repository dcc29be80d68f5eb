// Any text is either a data sheet or refused with one line that says why; nothing else comes out of the reader.
#include <breakaway/config/data_sheet.hpp>
#include <breakaway/input/input_error.hpp>

#include "require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), count);
  try {
    const auto sheet = breakaway::config::DataSheet::parse(text, "fuzz.eds");
    static_cast<void>(sheet.value(0x6076, 0));
  } catch (const breakaway::InputError& error) {
    breakaway::fuzz::require_one_line(error.what());
  }
  return 0;
}
