// Any text is a record or is refused with one line; a record has finite numbers only, and is the same when it is
// written and read again.
#include <breakaway/evaluation/record_csv.hpp>
#include <breakaway/input/input_error.hpp>
#include <cmath>

#include "require.hpp"

namespace {

using breakaway::fuzz::require;
namespace evaluation = breakaway::evaluation;

constexpr evaluation::RecordUnits units(std::string_view axis) {
  return {.period_s = 1e-3, .resolution_m = 1e-6, .force_step_N = 0.025, .axis = std::string{axis}};
}

std::size_t fresh_readings(const evaluation::Record& record) {
  std::size_t fresh = 0;
  for (const evaluation::Reading& reading : record.readings) {
    require(std::isfinite(reading.position_m) && std::isfinite(reading.command_N));
    fresh += reading.fresh ? 1U : 0U;
  }
  return fresh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), count);
  try {
    const auto record = evaluation::record_of_csv(text, units(count % 2 == 0 ? "" : "x"));
    const std::size_t fresh = fresh_readings(record);
    require(fresh == fresh_readings(evaluation::record_of_csv(evaluation::to_csv(record), units(""))));
  } catch (const breakaway::InputError& error) {
    breakaway::fuzz::require_one_line(error.what());
  }
  return 0;
}
