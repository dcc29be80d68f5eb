// Process data objects (CiA 301, 7.2.2): what a PDO carries, the SDO writes that make a node carry it, and the payload.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/hal/can_frame.hpp"

namespace breakaway::canopen {

// Bit 30 of a TPDO's COB-ID entry says that the PDO may not be asked for by a remote frame. A node that cannot answer
// such frames refuses an entry without it.
inline constexpr std::uint32_t no_remote_request = 0x4000'0000U;
// The transmission type of a PDO that acts at every SYNC.
inline constexpr std::uint8_t every_sync = 1;

struct MappedObject {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bits = 0;  // 1..64

  // The form in which 16xxh and 1Axxh hold it.
  constexpr std::uint32_t entry() const noexcept {
    return static_cast<std::uint32_t>(index) << 16 | static_cast<std::uint32_t>(subindex) << 8 | bits;
  }
  static constexpr MappedObject from_entry(std::uint32_t entry) noexcept {
    return {static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8),
            static_cast<std::uint8_t>(entry)};
  }
  friend constexpr bool operator==(const MappedObject&, const MappedObject&) = default;
};

struct PdoMapping {
  static constexpr std::size_t max_objects = 8;

  std::uint16_t parameter_index = 0;  // 1400h.. or 1800h..
  std::uint16_t mapping_index = 0;    // 1600h.. or 1A00h..
  std::uint32_t cob_id = 0;           // with its flags, valid
  std::uint8_t transmission_type = every_sync;
  std::uint8_t count = 0;  // of objects that are mapped, 0..max_objects
  std::array<MappedObject, max_objects> objects{};

  constexpr std::span<const MappedObject> mapped() const noexcept {
    return std::span{objects}.first(count <= max_objects ? count : max_objects);
  }
  // The payload's length, rounded up to whole bytes.
  constexpr std::size_t size_bytes() const noexcept {
    std::size_t bits = 0;
    for (const MappedObject& object : mapped()) bits += object.bits;
    return (bits + 7) / 8;
  }
};

// An object and the value that an expedited SDO transfer writes to it.
struct ObjectWrite {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t size = 0;  // 1..4 bytes
  std::uint32_t value = 0;
};

// The writes that remap a PDO, in the order that CiA 301 (7.5.2.36) demands: invalidate, empty, map, fill, validate.
constexpr std::size_t remap_step_count(const PdoMapping& pdo) noexcept { return pdo.mapped().size() + 5; }

// Returns one of those writes; step: 0..remap_step_count(pdo) - 1.
constexpr ObjectWrite remap_step(const PdoMapping& pdo, std::size_t step) noexcept {
  const std::size_t count = pdo.mapped().size();
  if (step == 0) return {pdo.parameter_index, 1, 4, pdo.cob_id | cob_id_invalid};
  if (step == 1) return {pdo.mapping_index, 0, 1, 0};
  if (step < count + 2)
    return {pdo.mapping_index, static_cast<std::uint8_t>(step - 1), 4, pdo.objects[step - 2].entry()};
  if (step == count + 2) return {pdo.mapping_index, 0, 1, static_cast<std::uint32_t>(count)};
  if (step == count + 3) return {pdo.parameter_index, 2, 1, pdo.transmission_type};
  return {pdo.parameter_index, 1, 4, pdo.cob_id};
}

// Packs the lowest `bits` of each value, one behind the other. Missing values count as zero. Signed values are passed
// as their two's complement. A mapping of more than 64 bits does not fit a PDO: what is beyond is not packed.
constexpr hal::CanFrame pack_pdo(const PdoMapping& pdo, std::span<const std::uint64_t> values) noexcept {
  std::uint64_t payload = 0;
  unsigned offset = 0;
  for (std::size_t i = 0; i < pdo.mapped().size() && i < values.size() && offset < 64; ++i) {
    const unsigned bits = pdo.objects[i].bits;
    const std::uint64_t mask = bits < 64 ? (std::uint64_t{1} << bits) - 1 : ~std::uint64_t{0};
    payload |= (values[i] & mask) << offset;
    offset += bits;
  }
  hal::CanFrame frame{
      .id = static_cast<std::uint16_t>(pdo.cob_id & hal::CanFrame::max_id), .size = 0, .remote = false, .data = {}};
  frame.size = static_cast<std::uint8_t>(pdo.size_bytes() <= 8 ? pdo.size_bytes() : 8);
  store_little_endian(frame.data, payload);
  return frame;
}

// Unpacks values.size() of the mapped objects, unsigned. Returns false, and writes nothing, when the frame is not this
// PDO or is shorter than its mapping.
constexpr bool unpack_pdo(const PdoMapping& pdo, const hal::CanFrame& frame, std::span<std::uint64_t> values) noexcept {
  if (frame.id != (pdo.cob_id & hal::CanFrame::max_id) || frame.remote || frame.payload().size() < pdo.size_bytes())
    return false;
  const auto payload = load_little_endian<std::uint64_t>(frame.payload());
  unsigned offset = 0;
  for (std::size_t i = 0; i < pdo.mapped().size() && i < values.size() && offset < 64; ++i) {
    const unsigned bits = pdo.objects[i].bits;
    const std::uint64_t mask = bits < 64 ? (std::uint64_t{1} << bits) - 1 : ~std::uint64_t{0};
    values[i] = (payload >> offset) & mask;
    offset += bits;
  }
  return true;
}

}  // namespace breakaway::canopen
