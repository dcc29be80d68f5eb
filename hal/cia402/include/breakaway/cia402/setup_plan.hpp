// SetupPlan: what is read from and written to a drive before it may run, as a list of expedited SDO transfers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "breakaway/canopen/network_config.hpp"
#include "breakaway/cia402/drive_config.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

struct SetupStep {
  enum class Kind : std::uint8_t { read, write };
  Kind kind = Kind::read;
  bool optional = false;  // the drive may lack the object, or have it fixed
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t size = 0;  // bytes of a write, 1..4
  std::uint32_t value = 0;
};

class SetupPlan {
 public:
  // The arguments must be what check() accepts.
  template <class Scalar>
  SetupPlan(const DriveConfig<Scalar>& drive, const canopen::NetworkConfig& network) noexcept
      : SetupPlan{drive.node_id, drive.heartbeat_period, drive.heartbeat_timeout, network} {}

  std::span<const SetupStep> steps() const noexcept { return std::span{steps_}.first(count_); }

 private:
  SetupPlan(std::uint8_t node_id, hal::Duration heartbeat_period, hal::Duration heartbeat_timeout,
            const canopen::NetworkConfig& network) noexcept;

  void read(std::uint16_t index, std::uint8_t subindex, bool optional) noexcept;
  void write(std::uint16_t index, std::uint8_t subindex, std::uint8_t size, std::uint32_t value,
             bool optional) noexcept;
  void add(const SetupStep& step) noexcept;

  std::array<SetupStep, 32> steps_{};
  std::size_t count_ = 0;
};

}  // namespace breakaway::cia402
