// The pre-defined connection set of CiA 301 (7.3.3): which CAN identifier carries what. node_id: 1..127; pdo: 1..4.
#pragma once

#include <cstdint>

namespace breakaway::canopen {

inline constexpr std::uint16_t kNmtCobId = 0x000;
inline constexpr std::uint16_t kSyncCobId = 0x080;
inline constexpr std::uint8_t kMinNodeId = 1;
inline constexpr std::uint8_t kMaxNodeId = 127;

// Bit 31 of a PDO's or EMCY's COB-ID entry: the object does not exist. Bit 30 of 1005h: the node produces SYNC.
inline constexpr std::uint32_t kCobIdInvalid = 0x8000'0000U;
inline constexpr std::uint32_t kSyncProducer = 0x4000'0000U;

constexpr std::uint16_t emcy_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x080U + node_id);
}
constexpr std::uint16_t tpdo_cob_id(unsigned pdo, std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x080U + 0x100U * pdo + node_id);
}
constexpr std::uint16_t rpdo_cob_id(unsigned pdo, std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x100U + 0x100U * pdo + node_id);
}
// The node that a frame of the predefined connection set belongs to; 0: all (NMT, SYNC, TIME).
constexpr std::uint8_t node_id_of(std::uint16_t cob_id) noexcept { return static_cast<std::uint8_t>(cob_id & 0x7FU); }
// Seen from the server (the drive): it receives requests and transmits responses.
constexpr std::uint16_t sdo_request_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x600U + node_id);
}
constexpr std::uint16_t sdo_response_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x580U + node_id);
}
constexpr std::uint16_t heartbeat_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x700U + node_id);
}

}  // namespace breakaway::canopen
