#include "breakaway/drive_emulator/sdo_server.hpp"

#include <algorithm>

#include "breakaway/canopen/bytes.hpp"

namespace breakaway::drive_emulator {

using canopen::SdoAbort;

namespace {

constexpr unsigned toggle_bit = 0x10;
constexpr std::size_t segment_bytes = 7;
constexpr std::size_t expedited_bytes = 4;
constexpr std::size_t max_download_bytes = 1024;  // longer than any entry; it bounds a client that never ends

enum Specifier : unsigned {  // bits 5..7 of a client's first byte
  download_segment_request = 0,
  download_request = 1,
  upload_request = 2,
  upload_segment_request = 3,
  abort_request = 4,
};

}  // namespace

std::optional<SdoServer::Payload> SdoServer::answer(const Payload& request) {
  const unsigned specifier = request[0] >> 5;
  if (specifier == upload_request || specifier == download_request) {
    reset();  // a client may start afresh at any time: it may have been restarted itself
    address_ = {canopen::load_little_endian<std::uint16_t>(request, 1), request[3]};
  }
  switch (specifier) {
    case download_segment_request:
      return download_segment(request);
    case download_request:
      return begin_download(request);
    case upload_request:
      return begin_upload();
    case upload_segment_request:
      return upload_segment(request);
    case abort_request:
      reset();
      return std::nullopt;
    default:
      return abort(SdoAbort::command_specifier);
  }
}

std::optional<SdoServer::Payload> SdoServer::refuse(const Payload& request, SdoAbort code) {
  if (request[0] >> 5 == abort_request) return std::nullopt;
  address_ = {canopen::load_little_endian<std::uint16_t>(request, 1), request[3]};
  return abort(code);
}

SdoServer::Payload SdoServer::reply(unsigned command) const {
  Payload payload{static_cast<std::uint8_t>(command)};
  canopen::store_little_endian(payload, address_.index, 1);
  payload[3] = address_.sub;
  return payload;
}

SdoServer::Payload SdoServer::abort(SdoAbort code) {
  reset();
  Payload payload = reply(0x80);
  canopen::store_little_endian(payload, static_cast<std::uint32_t>(code), 4);
  return payload;
}

SdoServer::Payload SdoServer::begin_segmented(Direction direction, std::uint32_t size) {
  direction_ = direction;
  toggle_ = false;
  done_bytes_ = 0;
  Payload payload = reply(direction == Direction::upload ? 0x41 : 0x60);
  if (direction == Direction::upload) canopen::store_little_endian(payload, size, 4);
  return payload;
}

SdoServer::Payload SdoServer::begin_upload() {
  if (const auto refused = dictionary_.read(address_, data_)) return abort(*refused);
  if (data_.empty() || data_.size() > expedited_bytes)
    return begin_segmented(Direction::upload, static_cast<std::uint32_t>(data_.size()));
  Payload payload = reply(0x43U | static_cast<unsigned>(expedited_bytes - data_.size()) << 2);
  std::ranges::copy(data_, payload.begin() + 4);
  return payload;
}

SdoServer::Payload SdoServer::upload_segment(const Payload& request) {
  if (direction_ != Direction::upload) return abort(SdoAbort::command_specifier);
  if (((request[0] & toggle_bit) != 0) != toggle_) return abort(SdoAbort::toggle_bit);
  const std::size_t count = std::min(segment_bytes, data_.size() - done_bytes_);
  const bool last = done_bytes_ + count == data_.size();
  Payload payload{static_cast<std::uint8_t>((toggle_ ? toggle_bit : 0U) |
                                            static_cast<unsigned>(segment_bytes - count) << 1 | (last ? 1U : 0U))};
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(done_bytes_), count, payload.begin() + 1);
  done_bytes_ += count;
  toggle_ = !toggle_;
  if (last) reset();
  return payload;
}

SdoServer::Payload SdoServer::begin_download(const Payload& request) {
  const bool expedited = (request[0] & 2U) != 0;
  const bool size_given = (request[0] & 1U) != 0;
  if (!expedited) {
    data_.clear();
    announced_bytes_.reset();
    if (size_given) announced_bytes_ = canopen::load_little_endian<std::uint32_t>(request, 4);
    // A wrong address is refused here already, not after all the data was sent.
    const Entry* entry = dictionary_.find(address_);
    if (entry == nullptr || entry->access == Access::read_only) return abort(*dictionary_.write(address_, {}));
    return begin_segmented(Direction::download, 0);
  }
  std::size_t count = expedited_bytes;
  if (size_given) {
    count -= (request[0] >> 2) & 3U;
  } else if (const Entry* entry = dictionary_.find(address_); entry != nullptr && entry->type != Type::text) {
    count = size_bytes(entry->type);  // the client leaves it to the server to know how many bytes count
  }
  data_.assign(request.begin() + 4, request.begin() + 4 + static_cast<std::ptrdiff_t>(count));
  return store();
}

SdoServer::Payload SdoServer::store() {
  if (const auto refused = dictionary_.write(address_, data_)) return abort(*refused);
  return reply(0x60);
}

SdoServer::Payload SdoServer::download_segment(const Payload& request) {
  if (direction_ != Direction::download) return abort(SdoAbort::command_specifier);
  if (((request[0] & toggle_bit) != 0) != toggle_) return abort(SdoAbort::toggle_bit);
  const std::size_t count = segment_bytes - ((request[0] >> 1) & 7U);
  data_.insert(data_.end(), request.begin() + 1, request.begin() + 1 + static_cast<std::ptrdiff_t>(count));
  if (data_.size() > announced_bytes_.value_or(max_download_bytes)) return abort(SdoAbort::length_mismatch);
  const unsigned answered_toggle = toggle_ ? toggle_bit : 0U;
  toggle_ = !toggle_;
  if ((request[0] & 1U) != 0) {
    reset();
    if (announced_bytes_ && data_.size() != *announced_bytes_) return abort(SdoAbort::length_mismatch);
    if (const auto refused = dictionary_.write(address_, data_)) return abort(*refused);
  }
  return Payload{static_cast<std::uint8_t>(0x20U | answered_toggle)};
}

}  // namespace breakaway::drive_emulator
