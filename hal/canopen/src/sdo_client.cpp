#include "breakaway/canopen/sdo_client.hpp"

#include <algorithm>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"

namespace breakaway::canopen {
namespace {

// Command bytes of the client: its specifier is in bits 5..7 (CiA 301, 7.2.4.3).
namespace command {
constexpr std::uint8_t write_segment = 0x00;
constexpr std::uint8_t initiate_write = 0x21;  // with the size indicated
constexpr std::uint8_t initiate_read = 0x40;
constexpr std::uint8_t read_segment = 0x60;
constexpr std::uint8_t abort = 0x80;
}  // namespace command

// Bits below the specifier, in commands of both sides.
namespace command_bit {
constexpr std::uint8_t toggle = 0x10;
constexpr std::uint8_t last_segment = 0x01;
constexpr std::uint8_t expedited = 0x02;
constexpr std::uint8_t size_indicated = 0x01;
}  // namespace command_bit

// Specifiers of the server.
namespace response {
constexpr unsigned read_segment = 0;
constexpr unsigned write_segment = 1;
constexpr unsigned initiate_read = 2;
constexpr unsigned initiate_write = 3;
constexpr unsigned abort = 4;
}  // namespace response

constexpr std::size_t expedited_bytes = 4;
constexpr std::size_t segment_bytes = 7;

constexpr unsigned specifier(std::uint8_t command) noexcept { return command >> 5U; }

std::array<std::uint8_t, 8> with_object(std::uint8_t command, ObjectAddress object) noexcept {
  std::array<std::uint8_t, 8> bytes{command};
  store_little_endian(bytes, object.index, 1);
  bytes[3] = object.subindex;
  return bytes;
}

}  // namespace

SdoClient::SdoClient(std::uint8_t node_id, hal::Duration timeout) noexcept : node_id_{node_id}, timeout_{timeout} {}

SdoStart SdoClient::start_read(std::uint16_t index, std::uint8_t subindex) noexcept {
  if (busy()) return SdoStart::busy;
  begin(Phase::initiate_read, index, subindex);
  size_ = 0;
  request_initiate_read();
  return SdoStart::started;
}

SdoStart SdoClient::start_write(std::uint16_t index, std::uint8_t subindex,
                                std::span<const std::uint8_t> bytes) noexcept {
  if (busy()) return SdoStart::busy;
  if (bytes.empty() || bytes.size() > capacity) return SdoStart::bad_length;
  begin(Phase::initiate_write, index, subindex);
  std::copy(bytes.begin(), bytes.end(), buffer_.begin());
  size_ = bytes.size();
  request_initiate_write();
  return SdoStart::started;
}

void SdoClient::begin(Phase phase, std::uint16_t index, std::uint8_t subindex) noexcept {
  phase_ = phase;
  object_ = {index, subindex};
  announced_ = 0;
  sent_ = 0;
  toggle_ = false;
  last_segment_ = false;
}

void SdoClient::request(const std::array<std::uint8_t, 8>& bytes) noexcept {
  request_ = {.id = sdo_request_cob_id(node_id_), .size = 8, .remote = false, .data = bytes};
  request_pending_ = true;
  awaiting_ = false;
}

void SdoClient::request_initiate_read() noexcept { request(with_object(command::initiate_read, object_)); }

void SdoClient::request_initiate_write() noexcept {
  auto bytes = with_object(command::initiate_write, object_);
  if (size_ <= expedited_bytes) {
    const auto unused = static_cast<unsigned>(expedited_bytes - size_);
    bytes[0] = static_cast<std::uint8_t>(command::initiate_write | command_bit::expedited | unused << 2U);
    std::copy_n(buffer_.begin(), size_, bytes.begin() + 4);
  } else {
    store_little_endian(bytes, static_cast<std::uint32_t>(size_), 4);
  }
  request(bytes);
}

void SdoClient::request_read_segment() noexcept {
  request({static_cast<std::uint8_t>(command::read_segment | (toggle_ ? command_bit::toggle : 0U))});
}

void SdoClient::request_write_segment() noexcept {
  const std::size_t count = std::min(size_ - sent_, segment_bytes);
  last_segment_ = sent_ + count == size_;
  const auto unused = static_cast<unsigned>(segment_bytes - count);
  std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(command::write_segment |
                                                              (toggle_ ? command_bit::toggle : 0U) | unused << 1U |
                                                              (last_segment_ ? command_bit::last_segment : 0U))};
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(sent_), count, bytes.begin() + 1);
  sent_ += count;
  request(bytes);
}

bool SdoClient::next_frame(hal::CanFrame& frame, hal::Time now) noexcept {
  if (abort_pending_) {
    abort_pending_ = false;
    frame = abort_;
    return true;
  }
  if (!request_pending_) return false;
  request_pending_ = false;
  awaiting_ = true;
  sent_at_ = now;
  frame = request_;
  return true;
}

SdoResult SdoClient::poll(hal::Time now) noexcept {
  if (awaiting_ && now - sent_at_ > timeout_) {
    tell_abort(SdoAbort::timeout);
    finish(SdoResult::timeout);
  }
  return busy() ? SdoResult::busy : result_;
}

bool SdoClient::names_object(const hal::CanFrame& frame) const noexcept {
  return load_little_endian<std::uint16_t>(frame.data, 1) == object_.index && frame.data[3] == object_.subindex;
}

void SdoClient::on_frame(const hal::CanFrame& frame) noexcept {
  if (!awaiting_ || frame.id != sdo_response_cob_id(node_id_) || frame.remote || frame.size != 8) return;
  const unsigned answer = specifier(frame.data[0]);
  if (answer == response::abort) {
    if (!names_object(frame)) return;
    abort_code_ = static_cast<SdoAbort>(load_little_endian<std::uint32_t>(frame.data, 4));
    finish(SdoResult::aborted);
  } else if (answer > response::abort) {
    refuse_command(SdoAbort::command_specifier, frame.data[0]);
  } else if (phase_ == Phase::initiate_read && answer == response::initiate_read) {
    on_initiate_read(frame);
  } else if (phase_ == Phase::initiate_write && answer == response::initiate_write) {
    on_initiate_write(frame);
  } else if (phase_ == Phase::read_segments && answer == response::read_segment) {
    on_read_segment(frame);
  } else if (phase_ == Phase::write_segments && answer == response::write_segment) {
    on_write_segment(frame);
  }
}

void SdoClient::on_initiate_read(const hal::CanFrame& frame) noexcept {
  if (!names_object(frame)) return;
  const std::uint8_t received = frame.data[0];
  const bool size_indicated = (received & command_bit::size_indicated) != 0;
  if ((received & command_bit::expedited) != 0) {
    size_ = size_indicated ? expedited_bytes - ((received >> 2U) & 3U) : expedited_bytes;
    std::copy_n(frame.data.begin() + 4, size_, buffer_.begin());
    finish(SdoResult::done);
    return;
  }
  announced_ = size_indicated ? load_little_endian<std::uint32_t>(frame.data, 4) : 0;
  if (announced_ > capacity) return refuse_length();
  phase_ = Phase::read_segments;
  request_read_segment();
}

void SdoClient::on_initiate_write(const hal::CanFrame& frame) noexcept {
  if (!names_object(frame)) return;
  if (size_ <= expedited_bytes) return finish(SdoResult::done);
  phase_ = Phase::write_segments;
  request_write_segment();
}

void SdoClient::on_read_segment(const hal::CanFrame& frame) noexcept {
  const std::uint8_t received = frame.data[0];
  if (((received & command_bit::toggle) != 0) != toggle_) return refuse_command(SdoAbort::toggle_bit, received);
  const std::size_t count = segment_bytes - ((received >> 1U) & 7U);
  const bool last = (received & command_bit::last_segment) != 0;
  // An empty segment that is not the last would let a server keep us here for ever.
  if (count == 0 && !last) return refuse_command(SdoAbort::length_too_low, received);
  if (size_ + count > capacity) return refuse_length();
  std::copy_n(frame.data.begin() + 1, count, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += count;
  if (last && announced_ != 0 && size_ != announced_) return refuse_command(SdoAbort::length_mismatch, received);
  if (last) return finish(SdoResult::done);
  toggle_ = !toggle_;
  request_read_segment();
}

void SdoClient::on_write_segment(const hal::CanFrame& frame) noexcept {
  if (((frame.data[0] & command_bit::toggle) != 0) != toggle_)
    return refuse_command(SdoAbort::toggle_bit, frame.data[0]);
  if (last_segment_) return finish(SdoResult::done);
  toggle_ = !toggle_;
  request_write_segment();
}

void SdoClient::finish(SdoResult result) noexcept {
  phase_ = Phase::idle;
  awaiting_ = false;
  request_pending_ = false;
  result_ = result;
}

// The server is told with the next frame.
void SdoClient::tell_abort(SdoAbort code) noexcept {
  auto bytes = with_object(command::abort, object_);
  store_little_endian(bytes, static_cast<std::uint32_t>(code), 4);
  abort_ = {.id = sdo_request_cob_id(node_id_), .size = 8, .remote = false, .data = bytes};
  abort_pending_ = true;
}

void SdoClient::refuse_command(SdoAbort code, std::uint8_t command) noexcept {
  tell_abort(code);
  unexpected_command_ = command;
  finish(SdoResult::protocol_error);
}

void SdoClient::refuse_length() noexcept {
  abort_code_ = SdoAbort::out_of_memory;
  tell_abort(abort_code_);
  finish(SdoResult::aborted);
}

void SdoClient::cancel() noexcept {
  abort_pending_ = false;
  finish(SdoResult::done);
}

}  // namespace breakaway::canopen
