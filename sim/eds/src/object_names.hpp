// What the objects of this project's devices are called, which no dictionary on a bus tells.
#pragma once

#include <cstdint>
#include <string>

namespace breakaway::eds {

// Numbers are those of CiA 306.
enum class Kind : std::uint8_t { variable = 7, array = 8, record = 9 };

struct ObjectName {
  std::string name;
  Kind kind = Kind::variable;
};

// These throw std::out_of_range for what is not in the tables.
ObjectName object_name(std::uint16_t index);
// sub: of an array or a record, from 0.
std::string entry_name(std::uint16_t index, std::uint8_t sub);

}  // namespace breakaway::eds
