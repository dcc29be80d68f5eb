// What is read from and written to a drive before it may run, as a list of expedited SDO transfers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "breakaway/hal/status.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

struct NodeConfig {
  std::uint8_t node_id = 1;           // 1..127
  std::uint8_t master_node_id = 127;  // 1..127, not node_id: who sends the heartbeats that the drive supervises
  hal::Duration heartbeat_period = std::chrono::milliseconds{100};   // of the drive; 1..65535 ms
  hal::Duration heartbeat_timeout = std::chrono::milliseconds{250};  // of both sides; above the period, to 65535 ms
  hal::Duration sdo_timeout = std::chrono::milliseconds{50};         // above 0
  hal::Duration period = std::chrono::milliseconds{1};               // of SYNC: 1..255 times 1 s, 0.1 s, ... or 1 us
};

struct SetupStep {
  enum class Kind : std::uint8_t { read, write };
  Kind kind = Kind::read;
  bool optional = false;  // the drive may lack the object, or have it fixed
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t size = 0;  // bytes, 1..4
  std::uint32_t value = 0;
};

class SetupPlan {
 public:
  explicit SetupPlan(const NodeConfig& config) noexcept;
  std::span<const SetupStep> steps() const noexcept { return std::span{steps_}.first(count_); }

 private:
  void read(std::uint16_t index, std::uint8_t subindex, bool optional) noexcept;
  void write(std::uint16_t index, std::uint8_t subindex, std::uint8_t size, std::uint32_t value,
             bool optional) noexcept;
  void add(const SetupStep& step) noexcept;

  std::array<SetupStep, 32> steps_{};
  std::size_t count_ = 0;
};

// The period as 60C2h wants it: units x 10^exponent seconds. Whole milliseconds with exponent -3 where they fit: some
// drives accept no other. Nothing when no pair is exact.
struct InterpolationPeriod {
  std::uint8_t units = 0;
  std::int8_t exponent = 0;  // -6..0
};
std::optional<InterpolationPeriod> interpolation_period(hal::Duration period) noexcept;

// ok, or invalid_argument with the field's place in NodeConfig as detail: 1 node_id, 2 master_node_id,
// 3 heartbeat_period, 4 heartbeat_timeout, 5 sdo_timeout, 6 period.
hal::Status check(const NodeConfig& config) noexcept;

}  // namespace breakaway::cia402
