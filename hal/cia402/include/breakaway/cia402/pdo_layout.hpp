// The two PDOs of a torque-controlled axis, both synchronous: 4 bytes to the drive, 8 bytes from it.
#pragma once

#include <cstdint>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/pdo.hpp"
#include "breakaway/cia402/objects.hpp"

namespace breakaway::cia402 {

// RPDO1 carries controlword and target torque.
constexpr canopen::PdoMapping command_pdo(std::uint8_t node_id) noexcept {
  return {.parameter_index = object::rpdo1_parameter,
          .mapping_index = object::rpdo1_mapping,
          .cob_id = canopen::rpdo_cob_id(1, node_id),
          .transmission_type = canopen::every_sync,
          .count = 2,
          .objects = {{{object::controlword, 0, 16}, {object::target_torque, 0, 16}}}};
}

// TPDO1 carries statusword, position and torque.
constexpr canopen::PdoMapping feedback_pdo(std::uint8_t node_id) noexcept {
  return {.parameter_index = object::tpdo1_parameter,
          .mapping_index = object::tpdo1_mapping,
          .cob_id = canopen::tpdo_cob_id(1, node_id) | canopen::no_remote_request,
          .transmission_type = canopen::every_sync,
          .count = 3,
          .objects = {{{object::statusword, 0, 16}, {object::position_actual, 0, 32}, {object::torque_actual, 0, 16}}}};
}

}  // namespace breakaway::cia402
