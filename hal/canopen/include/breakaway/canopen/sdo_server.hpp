// SdoServer: lets other nodes read and write the objects of this one (SDO, CiA 301, 7.2.4). Objects are read expedited
// or in segments, and written expedited, which has room for every number; blocks are refused, as the standard allows.
//
//   for every received frame: if (server.on_frame(frame)) it was for the server;
//   once a period: if (server.next_frame(frame, dictionary)) send it.
//
// It answers one request a call. A client waits for its answer before it asks again; if it does not, the newest request
// counts. Nothing that a client says or leaves unsaid makes the server wait: it keeps no time, and whoever starts a
// transfer ends the one before.
//
// It owns no port, never blocks or allocates, and is for one thread.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/object_address.hpp"
#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/hal/can_frame.hpp"

namespace breakaway::canopen {

// The types that objects have. The low half of the number is the size in bytes, 0 for text.
enum class ObjectType : std::uint8_t {
  text = 0x00,
  u8 = 0x01,
  u16 = 0x02,
  u32 = 0x04,
  i8 = 0x11,
  i16 = 0x12,
  i32 = 0x14,
  r32 = 0x24,
};
constexpr std::uint8_t size_bytes(ObjectType type) noexcept { return static_cast<std::uint8_t>(type) & 0x0FU; }

// What an object dictionary answers: a number of 1 to 4 bytes, a text, or why there is neither.
struct ObjectValue {
  SdoAbort abort = SdoAbort::none;
  ObjectType type = ObjectType::text;
  std::uint32_t number = 0;
  std::string_view text{};  // must stay where it is, because it is read in segments
};

// clang-format off
template <class D>
concept ServedObjects = requires(D& dictionary, ObjectAddress address, std::span<const std::uint8_t> bytes) {
  { dictionary.read(address) } noexcept -> std::same_as<ObjectValue>;
  // Of an object that is there. SdoAbort::none: it is done.
  { dictionary.write(address, bytes) } noexcept -> std::same_as<SdoAbort>;
};
// clang-format on

class SdoServer {
 public:
  // node_id: of this node, 1..127.
  explicit SdoServer(std::uint8_t node_id) noexcept : node_id_{node_id} {}

  // Takes any frame that the bus brought. Returns true for a request to this node, also for one that is malformed and
  // gets no answer.
  bool on_frame(const hal::CanFrame& frame) noexcept {
    return frame.id == sdo_request_cob_id(node_id_) && !frame.remote && take_request(frame);
  }

  // Returns true and fills `frame` when an answer is to be sent.
  template <ServedObjects Dictionary>
  bool next_frame(hal::CanFrame& frame, Dictionary& dictionary) noexcept {
    if (!waiting_) return false;
    waiting_ = false;
    switch (specifier()) {
      case Specifier::upload:
        frame = upload(dictionary.read(object()));
        return true;
      case Specifier::download:
        frame = downloaded(take(dictionary));
        return true;
      case Specifier::upload_segment:
        frame = next_segment();
        return true;
      case Specifier::abort:
        segments_left_ = false;
        return false;
    }
    frame = aborted(SdoAbort::command_specifier);
    return true;
  }

 private:
  // Bits 5 to 7 of the first byte of a request.
  enum class Specifier : std::uint8_t { download = 1, upload = 2, upload_segment = 3, abort = 4 };

  bool take_request(const hal::CanFrame& frame) noexcept;
  Specifier specifier() const noexcept { return static_cast<Specifier>(request_[0] >> 5U); }
  ObjectAddress object() const noexcept;
  bool is_expedited() const noexcept { return (request_[0] & 2U) != 0; }
  std::span<const std::uint8_t> written_bytes(std::size_t size_of_object) const noexcept;
  // No object here is longer than what an expedited download carries.
  template <ServedObjects Dictionary>
  SdoAbort take(Dictionary& dictionary) const noexcept {
    const ObjectValue present = dictionary.read(object());
    if (present.abort != SdoAbort::none) return present.abort;
    if (!is_expedited()) return SdoAbort::unsupported_access;
    return dictionary.write(object(), written_bytes(size_bytes(present.type)));
  }
  hal::CanFrame upload(const ObjectValue& value) noexcept;
  hal::CanFrame next_segment() noexcept;
  hal::CanFrame downloaded(SdoAbort abort) noexcept;
  hal::CanFrame aborted(SdoAbort code) noexcept;
  hal::CanFrame answer(unsigned command) const noexcept;

  std::uint8_t node_id_;
  std::array<std::uint8_t, 8> request_{};
  bool waiting_ = false;  // the request has no answer yet
  ObjectAddress read_{};  // the object whose segments are read
  std::string_view left_{};
  bool segments_left_ = false;
  bool toggle_ = false;  // that the next request of a segment must carry
};

}  // namespace breakaway::canopen
