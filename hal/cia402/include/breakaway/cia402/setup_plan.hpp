// SetupPlan: what is read from and written to a drive before it may run, as a list of expedited SDO transfers.
//
// The drive is switched off before anything else, because another tool may have left it with force, and its statusword
// is looked at now and then until the PDOs pass. What bounds its force (60B2h, 6072h, the option codes of its stops)
// and what makes it act (1005h) is written and read back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "breakaway/cia402/drive_config.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

struct SetupStep {
  enum class Kind : std::uint8_t {
    read,
    write,
    note,     // read whether it is `value`, which the drive loses when it boots
    recall,   // read whether it still is
    check,    // read, and it must be `value`
    confirm,  // the same, where the drive took the write before it
  };
  Kind kind = Kind::read;
  bool optional = false;  // the drive may abort the transfer, whatever for: it lacks the object, or has it fixed
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t size = 0;  // bytes of a write, 1..4
  std::uint32_t value = 0;
};

class SetupPlan {
 public:
  // The arguments must be what check() accepts.
  template <class Scalar>
  SetupPlan(const DriveConfig<Scalar>& drive, const hal::NetworkConfig& network) noexcept
      : SetupPlan{drive.node_id, drive.heartbeat_period, drive.heartbeat_timeout, network} {
    if (drive.homing.home == Home::by_drive) add_homing(drive.homing, drive.invert_direction);
    add_mode();
  }

  static constexpr std::size_t most_steps = 80;

  std::span<const SetupStep> steps() const noexcept { return std::span{steps_}.first(count_); }

 private:
  SetupPlan(std::uint8_t node_id, hal::Duration heartbeat_period, hal::Duration heartbeat_timeout,
            const hal::NetworkConfig& network) noexcept;

  void take_force_off() noexcept;
  void read_again(SetupStep::Kind kind, std::uint32_t consumer_heartbeat) noexcept;
  void read_rating() noexcept;
  void bound_force() noexcept;
  void add_clock(const hal::NetworkConfig& network) noexcept;
  void add_homing(const HomingConfig& homing, bool inverted) noexcept;
  void add_mode() noexcept;
  void look() noexcept;
  void read(std::uint16_t index, std::uint8_t subindex, bool optional) noexcept;
  void write(std::uint16_t index, std::uint8_t subindex, std::uint8_t size, std::uint32_t value,
             bool optional) noexcept;
  void read_back(SetupStep::Kind kind) noexcept;
  void add(const SetupStep& step) noexcept;

  std::array<SetupStep, most_steps> steps_{};
  std::size_t count_ = 0;
};

}  // namespace breakaway::cia402
