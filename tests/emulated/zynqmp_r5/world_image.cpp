// The world of the controller on the other core of the RPU: the project's drive emulators and plants, on the other
// CAN controller. It keeps the controller's time: a sixteenth of a period after each SYNC, when all that the controller
// says in a period has been said, the world passes to the next period and answers.
#include "breakaway/canopen/sync.hpp"
#include "can_node.hpp"
#include "controller_report.hpp"
#include "node_world.hpp"
#include "semihosting.hpp"

namespace {

using namespace breakaway;
using namespace breakaway::emulated;

constexpr std::uint32_t periods_to_run = ticks_to_run;
constexpr std::uint32_t cycles_per_period =
    zynqmp_r5::core_Hz / 1000 *
    static_cast<std::uint32_t>(flashed::node.loop.network.period / std::chrono::milliseconds{1});

enum ExitCode : std::uint32_t { done = 0, no_bus = 1, too_slow = 2, cannot_write = 3, lost_frames = 4 };

// Where the processor that starts the others waits for this one.
volatile std::uint32_t& ready() { return bare_metal::reg32(0xFFFC'0000); }

template <class Item>
bool write_file(std::string_view name, const std::vector<Item>& items) {
  HostFile file{name, OpenMode::write_binary};
  return file.is_open() && file.write(items.data(), items.size() * sizeof(Item));
}

class WorldNode {
 public:
  using Registers = zynqmp_r5::Can<1 - flashed::node.wiring.rpu_can_controller>;

  WorldNode()
      : port_{can_}, world_{periods_to_run, [this](const hal::CanFrame& frame) {
                              if (port_.send(frame, hal::Time::max()) != hal::SendResult::queued) ++refused_;
                            }} {}

  ExitCode run() {
    const auto timing =
        hal::bit_timing(zynqmp_r5::can_Hz, flashed::node.loop.network.bit_rate, xilinx_can::largest_prescaler);
    if (!timing || !port_.start({*timing, flashed::node.loop.network.bit_rate, {}}, 1000)) return no_bus;
    zynqmp_r5::CycleCounter::start();
    ready() = 1;
    while (world_.periods() < periods_to_run) {
      take_in_until_quiet();
      world_.pass_period();
      if (since_sync() > cycles_per_period - cycles_per_period / 16) return too_slow;
    }
    if (refused_ > 0 || port_.counters().overflows > 0) return lost_frames;
    return write_file("world.frames", world_.frames()) && write_file("world.positions", world_.positions_m())
               ? done
               : cannot_write;
  }

 private:
  // All that is said from the end of one period to shortly after the SYNC of the next.
  void take_in_until_quiet() {
    bool synced = false;
    while (!synced || since_sync() < cycles_per_period / 16) {
      zynqmp_r5::pause();
      port_.poll(hal::Time{});
      for (hal::ReceivedFrame received; port_.receive(received);) {
        world_.take(received.frame);
        if (!canopen::is_sync(received.frame)) continue;
        synced = true;
        sync_at_ = zynqmp_r5::CycleCounter::read();
      }
    }
  }
  std::uint32_t since_sync() const { return zynqmp_r5::CycleCounter::read() - sync_at_; }

  Registers can_;
  xilinx_can::Port<Registers> port_;
  std::uint32_t sync_at_ = 0;
  std::uint32_t refused_ = 0;
  NodeWorld world_;
};

}  // namespace

void run_image() {
  WorldNode node;
  exit_emulator(node.run());
}
