// How fast the loop can run before the bus is full.
#include <gtest/gtest.h>

#include <cstdio>

#include "breakaway/canopen/bus_budget.hpp"
#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

// Every axis is set up, enabled and brought to its target, and at most this share of the samples come back after their
// period.
bool keeps_up(unsigned axes, hal::Duration period, double late_share) {
  Rig rig{{.axes = axes, .period = period}};
  if (!rig.start()) return false;
  unsigned samples = 0, late = 0;
  for (const hal::Time end = rig.now() + 1s; rig.now() < end;) {
    rig.step();
    for (std::size_t i = 0; i < axes; ++i) {
      const auto& status = rig.status(i);
      if (!status.running) return false;
      ++samples;
      if (status.feedback.sample_time < rig.now() - period) ++late;
    }
  }
  const double tolerance_m = rig.parameters().accuracy_floor_m() + 2e-6;  // and two encoder counts
  for (std::size_t i = 0; i < axes; ++i) {
    if (std::abs(rig.position_m(i)) > tolerance_m) return false;
  }
  return late <= late_share * samples;
}

// 60C2h can say these, up to 255.
constexpr auto grid = 10us;

hal::Duration shortest_period(unsigned axes, double late_share) {
  const std::uint32_t needed_us = canopen::bus_budget(axes, 1ms, 1'000'000).needed_us;
  auto period = (1 + needed_us / 10) * hal::Duration{grid};
  if (!keeps_up(axes, period, late_share)) return 1s;
  while (period > grid && keeps_up(axes, period - grid, late_share)) period -= grid;
  return period;
}

double rate_Hz(hal::Duration period) { return 1e9 / static_cast<double>(period.count()); }

// Against the rates that worst-case stuffing of SYNC and PDOs allows: with a frame a period kept free for what is
// acyclic, as check_bus() wants it, no sample is late; with none, one in a hundred is, behind a heartbeat,
// and the axes arrive all the same.
TEST(LoopRate, ReachesWhatTheBusAllows) {
  for (unsigned axes = 1; axes <= 8; ++axes) {
    const double none_late_Hz = rate_Hz(shortest_period(axes, 0)), few_late_Hz = rate_Hz(shortest_period(axes, 0.01));
    const double promised_Hz = canopen::bus_budget(axes, 1ms, 1'000'000).max_rate_Hz;
    const double full_Hz = canopen::bus_budget(axes, 1ms, 1'000'000, {.frames = 0}).max_rate_Hz;
    std::printf("%u axes: %4.0f Hz of %4.0f, with few late samples %4.0f of %4.0f\n", axes, none_late_Hz, promised_Hz,
                few_late_Hz, full_Hz);
    EXPECT_GE(none_late_Hz, 0.95 * promised_Hz) << axes << " axes";
    EXPECT_GE(few_late_Hz, 0.95 * full_Hz) << axes << " axes";
  }
}

}  // namespace
}  // namespace breakaway::closed_loop
