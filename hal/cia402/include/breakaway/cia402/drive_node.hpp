// The CANopen side of one drive: waits for the node, sets it up by SDO beside the cyclic traffic, starts it, makes sure
// of its mode, and from then on watches heartbeat, NMT state and emergencies. A node that reboots is set up anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/heartbeat.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/cia402/setup_plan.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/status.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

enum class SetupPhase : std::uint8_t {
  waiting,         // for the node to show up in Pre-operational
  configuring,     // SDO transfers of the set-up plan
  starting,        // until the node says that it is NMT operational
  verifying_mode,  // until 6061h shows cyclic synchronous torque
  ready,           // until the node reboots or leaves NMT operational
  refused,         // until the node reboots; status() says why
};

// What the drive told of itself.
struct DriveRating {
  std::uint32_t rated_current_mA = 0;  // 0: not told
  std::uint32_t rated_torque_mNm = 0;
  std::uint16_t max_torque_per_mille = 1000;  // of the rated torque; a drive without 6072h is not driven beyond it
};

class DriveNode {
 public:
  // A node that is silent is told to reset its communication, and given so long to boot before it is told again.
  static constexpr hal::Duration boot_time = std::chrono::seconds{2};
  static constexpr unsigned sdo_attempts = 3;  // of one transfer, before the node counts as gone
  static constexpr hal::Duration mode_poll_time = std::chrono::milliseconds{20};
  static constexpr hal::Duration mode_request_time = std::chrono::milliseconds{500};
  static constexpr hal::Duration mode_timeout = std::chrono::seconds{10};  // drives were seen to take seconds

  explicit DriveNode(const NodeConfig& config) noexcept;

  void on_frame(const hal::ReceivedFrame& received) noexcept;
  void update(hal::Time now) noexcept;
  // At most one NMT command or SDO frame that is to be sent now. The master's heartbeat is not among them: it is one
  // for all its drives.
  bool next_frame(hal::CanFrame& frame, hal::Time now) noexcept;
  // Reads 603Fh, once the node is ready.
  void request_error_code() noexcept { error_code_wanted_ = true; }
  void forget_errors() noexcept;

  SetupPhase phase() const noexcept { return phase_; }
  bool ready() const noexcept { return phase_ == SetupPhase::ready; }
  // The node is NMT operational with our mapping: PDOs pass.
  bool operational() const noexcept { return phase_ == SetupPhase::verifying_mode || ready(); }
  // ok when ready; would_block while it is on the way (detail: object index << 8 | sub-index); timeout when an SDO
  // transfer was not answered and the node is waited for again (same detail); else why the node is refused.
  hal::Status status() const noexcept { return status_; }
  // The object at which the set-up stands or was refused: index << 8 | sub-index.
  std::uint32_t setup_object() const noexcept { return setup_object_; }
  const DriveRating& rating() const noexcept { return rating_; }
  std::uint16_t error_code() const noexcept { return error_code_; }  // 603Fh as last read; 0: not read
  std::optional<canopen::NmtState> nmt_state() const noexcept { return heartbeat_.state(); }
  bool heartbeat_lost() const noexcept { return heartbeat_.lost(); }
  const canopen::EmcyConsumer& emcy() const noexcept { return emcy_; }
  std::uint32_t reboots() const noexcept { return reboots_; }  // that nobody here asked for

 private:
  void wait_for_node(hal::Time now) noexcept;
  void begin_configuration(hal::Time now) noexcept;
  void configure(hal::Time now) noexcept;
  void start_transfer(const SetupStep& step) noexcept;
  void on_step_done(const SetupStep& step, hal::Time now) noexcept;
  void on_step_failed(const SetupStep& step, hal::Status result, hal::Time now) noexcept;
  void on_value_read(std::uint16_t index) noexcept;
  void begin_start(hal::Time now) noexcept;
  bool stopped_operating(hal::Time now) noexcept;
  void start_node(hal::Time now) noexcept;
  void verify_mode(hal::Time now) noexcept;
  void on_mode_transfer(hal::Status result, hal::Time now) noexcept;
  void watch(hal::Time now) noexcept;
  void enter(SetupPhase phase, hal::Time now) noexcept;
  void refuse(hal::Status status) noexcept;

  NodeConfig config_;
  SetupPlan plan_;
  canopen::SdoClient sdo_;
  canopen::HeartbeatConsumer heartbeat_;
  canopen::EmcyConsumer emcy_;

  SetupPhase phase_ = SetupPhase::waiting;
  hal::Status status_{hal::StatusCode::would_block};
  bool config_valid_ = false;
  std::optional<hal::Time> since_;         // when the phase was entered
  std::optional<hal::Time> last_command_;  // when NMT was last told something in this phase
  std::optional<canopen::NmtCommand> nmt_command_;
  std::size_t step_ = 0;
  unsigned attempts_ = 0;
  bool transfer_running_ = false;
  bool mode_write_ = false;  // the running transfer is a renewed request of the mode
  hal::Time last_mode_request_{};
  std::optional<hal::Time> last_mode_poll_;
  std::uint32_t setup_object_ = 0;
  DriveRating rating_;
  bool error_code_wanted_ = false;
  std::uint16_t error_code_ = 0;
  std::uint32_t reboots_ = 0;
};

}  // namespace breakaway::cia402
