#include "breakaway/canopen/sdo_server.hpp"

#include <algorithm>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"

namespace breakaway::canopen {
namespace {

constexpr std::size_t bytes_of_number = 4, bytes_of_segment = 7;
constexpr unsigned toggled = 0x10;

// The first byte of an answer.
namespace reply {
constexpr unsigned segment = 0x00, uploaded_in_segments = 0x41, uploaded_expedited = 0x43, downloaded = 0x60,
                   abort = 0x80;
}  // namespace reply

}  // namespace

bool SdoServer::take_request(const hal::CanFrame& frame) noexcept {
  if (frame.size != request_.size()) return true;
  request_ = frame.data;
  waiting_ = true;
  return true;
}

ObjectAddress SdoServer::object() const noexcept {
  return {load_little_endian<std::uint16_t>(request_, 1), request_[3]};
}

// A client may leave it to the server to know how many of the four bytes count.
std::span<const std::uint8_t> SdoServer::written_bytes(std::size_t size_of_object) const noexcept {
  const bool size_indicated = (request_[0] & 1U) != 0;
  const std::size_t indicated = bytes_of_number - ((request_[0] >> 2U) & 3U);
  return std::span{request_}.subspan(4).first(size_indicated ? indicated : std::min(size_of_object, bytes_of_number));
}

hal::CanFrame SdoServer::answer(unsigned command) const noexcept {
  hal::CanFrame frame{.id = sdo_response_cob_id(node_id_), .size = 8, .remote = false, .data = {}};
  frame.data[0] = static_cast<std::uint8_t>(command);
  std::copy_n(request_.begin() + 1, 3, frame.data.begin() + 1);
  return frame;
}

hal::CanFrame SdoServer::aborted(SdoAbort code) noexcept {
  segments_left_ = false;
  hal::CanFrame frame = answer(reply::abort);
  store_little_endian(frame.data, static_cast<std::uint32_t>(code), 4);
  return frame;
}

hal::CanFrame SdoServer::upload(const ObjectValue& value) noexcept {
  if (value.abort != SdoAbort::none) return aborted(value.abort);
  const std::size_t size = size_bytes(value.type);
  segments_left_ = size == 0;
  if (size > 0) {
    const auto unused = static_cast<unsigned>(bytes_of_number - std::min(size, bytes_of_number));
    hal::CanFrame frame = answer(reply::uploaded_expedited | unused << 2U);
    store_little_endian(frame.data, value.number, 4);
    return frame;
  }
  read_ = object();
  left_ = value.text;
  toggle_ = false;
  hal::CanFrame frame = answer(reply::uploaded_in_segments);
  store_little_endian(frame.data, static_cast<std::uint32_t>(left_.size()), 4);
  return frame;
}

hal::CanFrame SdoServer::next_segment() noexcept {
  // The request of a segment does not name the object; an abort does.
  request_[1] = static_cast<std::uint8_t>(read_.index);
  request_[2] = static_cast<std::uint8_t>(read_.index >> 8U);
  request_[3] = read_.subindex;
  if (!segments_left_) return aborted(SdoAbort::command_specifier);
  if (((request_[0] & toggled) != 0) != toggle_) return aborted(SdoAbort::toggle_bit);
  const std::size_t count = std::min(left_.size(), bytes_of_segment);
  segments_left_ = count < left_.size();
  hal::CanFrame frame{.id = sdo_response_cob_id(node_id_), .size = 8, .remote = false, .data = {}};
  frame.data[0] =
      static_cast<std::uint8_t>(reply::segment | (toggle_ ? toggled : 0U) |
                                static_cast<unsigned>(bytes_of_segment - count) << 1U | (segments_left_ ? 0U : 1U));
  std::copy_n(left_.begin(), count, frame.data.begin() + 1);
  left_.remove_prefix(count);
  toggle_ = !toggle_;
  return frame;
}

hal::CanFrame SdoServer::downloaded(SdoAbort abort) noexcept {
  segments_left_ = false;
  return abort == SdoAbort::none ? answer(reply::downloaded) : aborted(abort);
}

}  // namespace breakaway::canopen
