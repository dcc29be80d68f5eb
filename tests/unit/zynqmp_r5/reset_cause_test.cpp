#include "reset_cause.hpp"

#include <gtest/gtest.h>

#include <map>

namespace {

using breakaway::zynqmp_r5::ResetCause;
using breakaway::zynqmp_r5::take_reset_cause;

// Flags that a one clears (UG1087).
class FlagsModel {
 public:
  static constexpr std::uintptr_t reset_reason = 0xFF5E'0220, error_status = 0xFFD8'0530;

  FlagsModel(std::uint32_t reasons, std::uint32_t errors) : flags_{{reset_reason, reasons}, {error_status, errors}} {}
  std::uint32_t read(std::uintptr_t address) noexcept { return flags_.at(address); }
  void write(std::uintptr_t address, std::uint32_t value) noexcept { flags_.at(address) &= ~value; }

 private:
  std::map<std::uintptr_t, std::uint32_t> flags_;
};

constexpr std::uint32_t watchdog = 1U << 12;

struct Case {
  const char* label;
  std::uint32_t reasons, errors;
  ResetCause expected;
};

constexpr Case cases[] = {
    {"power came", 1U << 0, 0, ResetCause::power},
    {"what other flags say when power comes counts for nothing", 1U << 0 | 1U << 4, watchdog, ResetCause::power},
    {"the watchdog reset the system", 1U << 2, watchdog, ResetCause::watchdog},
    {"a boot loader took the reason", 0, watchdog, ResetCause::watchdog},
    {"the watchdog of the full-power domain", 1U << 2, 1U << 13, ResetCause::system_error},
    {"the firmware of the PMU took the error", 1U << 2, 0, ResetCause::system_error},
    {"an error reset as power does", 1U << 1, 0, ResetCause::system_error},
    {"software reset the processing system alone", 1U << 3, 0, ResetCause::software},
    {"the reset pin", 1U << 4, 0, ResetCause::pin},
    {"software", 1U << 5, 0, ResetCause::software},
    {"a debugger", 1U << 6, 0, ResetCause::debugger},
    {"nothing", 0, 0, ResetCause::unknown},
};

TEST(ResetCause, IsReadFromTheFlagsAndForgotten) {
  for (const Case& c : cases) {
    FlagsModel chip{c.reasons, c.errors};
    EXPECT_EQ(take_reset_cause(chip), c.expected) << c.label;
    EXPECT_EQ(take_reset_cause(chip), ResetCause::unknown) << c.label;
    EXPECT_EQ(chip.read(FlagsModel::error_status), c.errors & ~watchdog) << "the flags of others stay: " << c.label;
  }
}

TEST(ResetCause, OfTheWatchdogSaysWhatThatMeans) {
  EXPECT_NE(to_string(ResetCause::watchdog).find("longer than its period"), std::string_view::npos);
}

}  // namespace
