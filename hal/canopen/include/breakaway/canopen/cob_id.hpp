// The pre-defined connection set of CiA 301 (7.3.3): which CAN identifier carries what.
//
// A COB-ID is a function code in its upper four bits and a node id in the lower seven. Every function below takes node
// ids from 1 to 127 and PDO numbers from 1 to 4, and returns an identifier of 11 bits.
#pragma once

#include <cstdint>

namespace breakaway::canopen {

inline constexpr std::uint8_t min_node_id = 1;
inline constexpr std::uint8_t max_node_id = 127;

constexpr bool is_node_id(std::uint8_t id) noexcept { return id >= min_node_id && id <= max_node_id; }

inline constexpr std::uint16_t function_code_mask = 0x780;
inline constexpr std::uint16_t node_id_mask = 0x07F;

inline constexpr std::uint16_t nmt_cob_id = 0x000;
inline constexpr std::uint16_t sync_cob_id = 0x080;

// These carry a node id as well.
inline constexpr std::uint16_t emcy_function_code = 0x080;
inline constexpr std::uint16_t sdo_response_function_code = 0x580;
inline constexpr std::uint16_t sdo_request_function_code = 0x600;
inline constexpr std::uint16_t heartbeat_function_code = 0x700;

// Flags of the COB-ID entries in an object dictionary. Bit 31 of a PDO's or EMCY's entry says that the object does not
// exist; bit 30 of 1005h, that the node produces SYNC.
inline constexpr std::uint32_t cob_id_invalid = 0x8000'0000U;
inline constexpr std::uint32_t sync_producer = 0x4000'0000U;

constexpr std::uint16_t emcy_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(emcy_function_code + node_id);
}
constexpr std::uint16_t tpdo_cob_id(unsigned pdo, std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x080U + 0x100U * pdo + node_id);
}
constexpr std::uint16_t rpdo_cob_id(unsigned pdo, std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(0x100U + 0x100U * pdo + node_id);
}
// Requests and responses are meant from the server's side: a drive receives requests and transmits responses.
constexpr std::uint16_t sdo_request_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(sdo_request_function_code + node_id);
}
constexpr std::uint16_t sdo_response_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(sdo_response_function_code + node_id);
}
constexpr std::uint16_t heartbeat_cob_id(std::uint8_t node_id) noexcept {
  return static_cast<std::uint16_t>(heartbeat_function_code + node_id);
}

constexpr std::uint16_t function_code_of(std::uint16_t cob_id) noexcept {
  return static_cast<std::uint16_t>(cob_id & function_code_mask);
}
// Returns 0 for the frames that concern all nodes: NMT, SYNC and TIME.
constexpr std::uint8_t node_id_of(std::uint16_t cob_id) noexcept {
  return static_cast<std::uint8_t>(cob_id & node_id_mask);
}

}  // namespace breakaway::canopen
