#include "listen.hpp"

#include <fmt/format.h>

#include <bitset>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/cia402/overheard.hpp"
#include "realtime.hpp"

namespace breakaway::linux_node {
namespace {

// What the first TPDO of an axis' drive says, if the frame is that.
std::optional<StepRecord> heard(const hal::ReceivedFrame& received, const Configuration& c, std::size_t place) {
  const auto& drive = c.drive(place);
  const auto told = cia402::overheard_feedback(received.frame, drive.node_id, drive.invert_direction);
  if (!told) return {};
  return StepRecord{.time = received.time,
                    .target_counts = told->position_counts,
                    .position_counts = told->position_counts,
                    .reported_N = c.axes[place].force_per_per_mille_N * static_cast<float>(told->torque_per_mille),
                    .drive = told->state,
                    .axis = static_cast<std::uint8_t>(place),
                    .controlled = false};
}

// Who was there, for an operator who waits for samples in vain.
class Heard {
 public:
  void add(const hal::CanFrame& frame) {
    ++frames_;
    if (canopen::function_code_of(frame.id) == canopen::heartbeat_function_code)
      nodes_.set(frame.id - canopen::heartbeat_function_code);
  }

  std::string sentence() const {
    if (frames_ == 0)
      return "no frame was heard: check power, wiring and bit rate; a drive that nobody has set up may be silent, too";
    std::string nodes;
    for (std::size_t id = 1; id < nodes_.size(); ++id)
      if (nodes_[id]) nodes += fmt::format("{}{}", nodes.empty() ? "" : ", ", id);
    return fmt::format(
        "{} frames were heard, none of them a sample of a drive of this file; heartbeats are of {}. A drive sends "
        "samples once a master has set it up and sends SYNC",
        frames_, nodes.empty() ? "nobody" : "node " + nodes);
  }

 private:
  std::size_t frames_ = 0;
  std::bitset<128> nodes_;
};

}  // namespace

ExitCode listen(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
                Telemetry& telemetry) {
  socketcan::Port<socketcan::KernelSocket> port{socket};
  Ticker ticker{configuration.loop().network.period};
  const hal::Time begin = monotonic_now();
  const hal::Duration duration{std::llround(options.duration_s * 1e9)};
  bool any = false;
  Heard others;
  telemetry.ready = true;
  for (hal::Time now = begin; !telemetry.stop && (duration == hal::Duration::zero() || now - begin < duration);) {
    now = ticker.wait();
    if (ticker.in_time()) telemetry.periods.fetch_add(1, std::memory_order_relaxed);
    port.poll(now);
    for (hal::ReceivedFrame received; port.receive(received);) {
      telemetry.add(FrameRecord{received.time, received.frame});
      others.add(received.frame);
      for (std::size_t place = 0; place < configuration.axes.size(); ++place) {
        const auto record = heard(received, configuration, place);
        if (!record) continue;
        telemetry.add(*record);
        any = true;
      }
    }
  }
  telemetry.stopping = true;
  if (!any) fmt::print(stderr, "breakaway-node: {}: {}\n", options.interface, others.sentence());
  return any ? done : failed;
}

}  // namespace breakaway::linux_node
