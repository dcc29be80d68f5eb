#include "watchdog.hpp"

#include <gtest/gtest.h>

namespace {

using namespace std::chrono_literals;

// The watchdog by its registers (UG1087, module SWDT): what lacks its key is ignored.
class WatchdogModel {
 public:
  void write(std::uint32_t offset, std::uint32_t value) noexcept {
    if (offset == 0x0 && value >> 12 == 0xABC) mode_ = value & 0xFFF;
    if (offset == 0x4 && value >> 14 == 0x248) {
      EXPECT_FALSE(enabled()) << "the counter's start is set while it stands";
      control_ = value & 0x3FFF;
    }
    if (offset == 0x8 && value == 0x1999) left_ = reload();
  }
  bool enabled() const { return (mode_ & 1U) != 0; }
  bool resets() const { return (mode_ & 2U) != 0; }
  std::uint32_t reload() const { return (control_ >> 2 << 12 | 0xFFF) + 1; }
  std::uint32_t divider() const { return 8U << (3 * (control_ & 3U)); }
  // Until it would reset the processor.
  double left_s(double clock_Hz) const { return double(left_) * divider() / clock_Hz; }
  void pass(double time_s, double clock_Hz) { left_ -= static_cast<std::uint32_t>(time_s * clock_Hz / divider()); }

 private:
  std::uint32_t mode_ = 0, control_ = 0x3FFC, left_ = 0xFFFFFF;
};

using Watchdog = breakaway::zynqmp_r5::Watchdog<WatchdogModel>;
constexpr std::uint32_t clock_Hz = 100'000'000;

TEST(Watchdog, ResetsNotBeforeItsTimeoutAndSoonAfter) {
  for (const auto timeout : {1us, 327us, 328us, 3000us, 1'300'000us}) {
    WatchdogModel model;
    ASSERT_TRUE(Watchdog{model}.start(clock_Hz, timeout));
    EXPECT_TRUE(model.enabled() && model.resets());
    const double timeout_s = breakaway::hal::seconds(timeout);
    EXPECT_GE(model.left_s(clock_Hz), timeout_s);
    EXPECT_LE(model.left_s(clock_Hz), timeout_s + 328e-6) << "one unit of 32768 clocks";
  }
}

TEST(Watchdog, StartsAnewWhenServed) {
  WatchdogModel model;
  Watchdog watchdog{model};
  ASSERT_TRUE(watchdog.start(clock_Hz, 3ms));
  const double full_s = model.left_s(clock_Hz);
  model.pass(2e-3, clock_Hz);
  ASSERT_LT(model.left_s(clock_Hz), full_s);
  watchdog.serve();
  EXPECT_EQ(model.left_s(clock_Hz), full_s);
}

TEST(Watchdog, RefusesWhatItsCounterDoesNotHold) {
  WatchdogModel model;
  EXPECT_FALSE(Watchdog{model}.start(clock_Hz, 2s));
  EXPECT_FALSE(Watchdog{model}.start(clock_Hz, 0s));
  EXPECT_FALSE(Watchdog{model}.start(0, 3ms));
  EXPECT_FALSE(model.enabled());
}

}  // namespace
