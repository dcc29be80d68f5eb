// What a drive said of its error, for people.
#pragma once

#include <cstdint>
#include <string>

#include "telemetry.hpp"

namespace breakaway::linux_node {

// Of a drive of CiA 402. code: of EMCY or 603Fh. error_register: 1001h, 0 where it is not known.
std::string error_text(std::uint16_t code, std::uint8_t error_register);

// Of any drive.
std::string error_text(const StepRecord& step);

// Why a drive that was told to enable is not enabled.
std::string why_disabled(const StepRecord& step);

}  // namespace breakaway::linux_node
