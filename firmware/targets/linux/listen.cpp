#include "listen.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "breakaway/canopen/pdo.hpp"
#include "breakaway/cia402/pdo_layout.hpp"
#include "breakaway/cia402/state.hpp"
#include "realtime.hpp"

namespace breakaway::linux_node {
namespace {

hal::DriveState shown_state(cia402::State state) {
  switch (state) {
    case cia402::State::operation_enabled:
      return hal::DriveState::enabled;
    case cia402::State::quick_stop_active:
    case cia402::State::fault_reaction_active:
      return hal::DriveState::stopping;
    case cia402::State::fault:
      return hal::DriveState::fault;
    case cia402::State::not_ready_to_switch_on:
    case cia402::State::switch_on_disabled:
    case cia402::State::ready_to_switch_on:
    case cia402::State::switched_on:
      break;
  }
  return hal::DriveState::disabled;
}

// What the first TPDO of an axis' drive says, if the frame is that.
std::optional<StepRecord> heard(const hal::ReceivedFrame& received, const Configuration& c, std::size_t place) {
  std::array<std::uint64_t, 3> values{};
  const auto& axis = c.node.axes[place];
  if (!canopen::unpack_pdo(cia402::feedback_pdo(axis.drive.node_id), received.frame, values)) return {};
  StepRecord record{.time = received.time, .axis = static_cast<std::uint8_t>(place), .controlled = false};
  const std::int32_t sign = axis.drive.invert_direction ? -1 : 1;
  if (const auto state = cia402::state_of(static_cast<std::uint16_t>(values[0]))) record.drive = shown_state(*state);
  const auto counts = static_cast<std::uint32_t>(values[1]);
  record.position_counts = static_cast<std::int32_t>(sign < 0 ? 0U - counts : counts);
  record.target_counts = record.position_counts;
  record.reported_N = static_cast<float>(sign) * c.axes[place].force_per_per_mille_N *
                      static_cast<float>(static_cast<std::int16_t>(static_cast<std::uint16_t>(values[2])));
  return record;
}

}  // namespace

ExitCode listen(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
                Telemetry& telemetry) {
  socketcan::Port<socketcan::KernelSocket> port{socket};
  Ticker ticker{configuration.node.loop.network.period};
  const hal::Time begin = monotonic_now();
  const hal::Duration duration{std::llround(options.duration_s * 1e9)};
  bool any = false;
  telemetry.ready = true;
  for (hal::Time now = begin; !telemetry.stop && (duration == hal::Duration::zero() || now - begin < duration);) {
    now = ticker.wait();
    if (ticker.in_time()) telemetry.periods.fetch_add(1, std::memory_order_relaxed);
    port.poll(now);
    for (hal::ReceivedFrame received; port.receive(received);) {
      telemetry.add(FrameRecord{received.time, received.frame});
      for (std::size_t place = 0; place < configuration.axes.size(); ++place) {
        const auto record = heard(received, configuration, place);
        if (!record) continue;
        telemetry.add(*record);
        any = true;
      }
    }
  }
  telemetry.stopping = true;
  return any ? done : failed;
}

}  // namespace breakaway::linux_node
