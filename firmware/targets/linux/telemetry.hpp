// What leaves the control thread: records through a fixed ring without a lock, wishes from the operator the other way.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <variant>

#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/hal/shared_ring.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::linux_node {

struct StepRecord {
  hal::Time time{};
  hal::Duration latency{};
  std::int32_t target_counts = 0;
  std::int32_t position_counts = 0;
  float command_N = 0;
  float reported_N = 0;
  law::Mode mode{};
  hal::DriveState drive{};
  firmware::AxisFault fault{};
  std::uint16_t fault_code = 0;
  std::uint8_t error_register = 0;  // 1001h, as the last EMCY had it
  std::uint16_t statusword = 0;
  // Of a drive that has neither of the two above; text of the program.
  std::string_view code_text{};   // what fault_code means
  std::string_view setup_text{};  // how its set-up stands
  std::uint8_t axis = 0;          // place in the node
  bool controlled = true;         // false: only listened to; mode and command say nothing
  bool stop_not_obeyed = false;   // since the last reset
  bool link_lost = false;         // the interface is down or gone
  bool reset_refused = false;     // the operator's, in this step
};

struct FrameRecord {
  hal::Time time{};
  hal::CanFrame frame;
};

using Record = std::variant<StepRecord, FrameRecord>;
static_assert(std::is_trivially_copyable_v<Record>);

struct Telemetry {
  hal::SharedRing<Record, 16384> records;                             // two seconds and more at 1 kHz
  std::atomic<std::uint64_t> lost{0};                                 // records that the ring had no room for
  std::atomic<std::uint64_t> csv_unwritten{0}, candump_unwritten{0};  // records that these logs lack at the end
  std::atomic<bool> stop{false};                                      // the operator's: SIGINT, SIGTERM, SIGHUP
  std::atomic<bool> reset{false};                                     // SIGUSR1
  std::atomic<bool> finished{false};                                  // the control thread's: nothing more comes
  std::atomic<bool> ready{false};                                     // the control thread's: what it is for has begun
  std::atomic<bool> stopping{false};      // the control thread's: its axes are being stopped
  std::atomic<std::uint64_t> periods{0};  // that the control thread began in time

  void add(const Record& record) noexcept {
    if (!records.push(record)) lost.fetch_add(1, std::memory_order_relaxed);
  }
};

// A CanPort that notes what passes.
template <hal::CanPort Port>
class NotedPort {
 public:
  NotedPort(Port& port, Telemetry& telemetry) noexcept : port_{&port}, telemetry_{&telemetry} {}

  void set_time(hal::Time now) noexcept { now_ = now; }

  hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    const hal::SendResult result = port_->send(frame, deadline);
    if (result == hal::SendResult::queued) telemetry_->add(FrameRecord{now_, frame});
    return result;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (!port_->receive(received)) return false;
    telemetry_->add(FrameRecord{received.time, received.frame});
    return true;
  }
  void purge_transmit_queue() noexcept { port_->purge_transmit_queue(); }
  hal::BusState bus_state() const noexcept { return port_->bus_state(); }

 private:
  Port* port_;
  Telemetry* telemetry_;
  hal::Time now_{};
};

}  // namespace breakaway::linux_node
