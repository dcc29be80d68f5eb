// ObjectAddress: where an object lies in a device's object dictionary (CiA 301, 7.4).
#pragma once

#include <cstdint>

namespace breakaway::canopen {

struct ObjectAddress {
  std::uint16_t index = 0;  // 0 addresses nothing
  std::uint8_t subindex = 0;

  friend constexpr bool operator==(ObjectAddress, ObjectAddress) = default;
};

}  // namespace breakaway::canopen
