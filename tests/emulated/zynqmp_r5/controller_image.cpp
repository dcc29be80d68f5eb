// The controller node as it is flashed, but that it ends after a number of periods, tells how they went, and that the
// emulated cycle counter runs at 1 GHz (BREAKAWAY_CORE_HZ).
#include "can_node.hpp"
#include "controller_report.hpp"
#include "semihosting.hpp"

extern "C" {
// Marks between which an emulator counts instructions.
[[gnu::noinline]] void count_begin() { asm volatile("" ::: "memory"); }
[[gnu::noinline]] void count_end() { asm volatile("" ::: "memory"); }
}

void run_image() {
  using namespace breakaway;
  static zynqmp_r5::CanNode node;
  emulated::ControllerReport report;
  bare_metal::Memory system;
  report.start_result = static_cast<std::uint32_t>(node.start(zynqmp_r5::take_reset_cause(system)));
  firmware::TimingStatistics statistics{flashed::node.loop.network.period};
  while (report.start_result == static_cast<std::uint32_t>(zynqmp_r5::StartResult::running) &&
         statistics.ticks() < emulated::ticks_to_run) {
    const hal::Time now = node.wait();
    statistics.begin(now);
    count_begin();
    node.command(now);
    count_end();
    const hal::Time sync = node.wait_for_sync();
    count_begin();
    node.sync(sync);
    count_end();
    if (!node.in_time()) ++report.late;
  }
  report.ticks = static_cast<std::uint32_t>(statistics.ticks());
  report.missed = static_cast<std::uint32_t>(statistics.missed_ticks());
  report.lost_frames = node.port().counters().overflows + node.port().counters().stale;
  emulated::HostFile{"controller.report", emulated::OpenMode::write_binary}.write(&report, sizeof report);
}
