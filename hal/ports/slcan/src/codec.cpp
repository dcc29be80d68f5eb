#include "breakaway/slcan/codec.hpp"

namespace breakaway::slcan {
namespace {

constexpr int digit_value(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

// Returns the number that `digits` spell, or nothing when one of them is not a hexadecimal digit.
std::optional<std::uint32_t> parse_hex(std::span<const char> digits) noexcept {
  std::uint32_t value = 0;
  for (const char c : digits) {
    const int digit = digit_value(c);
    if (digit < 0) return {};
    value = value << 4 | static_cast<std::uint32_t>(digit);
  }
  return value;
}

std::optional<hal::CanFrame> parse_frame(std::span<const char> line) noexcept {
  constexpr std::size_t header = 5, time_stamp = 4;
  if (line.size() < header) return {};
  const auto id = parse_hex(line.subspan(1, 3));
  const int size = digit_value(line[4]);
  if (!id || *id > 0x7FF || size < 0 || size > 8) return {};
  hal::CanFrame frame{.id = static_cast<std::uint16_t>(*id),
                      .size = static_cast<std::uint8_t>(size),
                      .remote = line[0] == 'r',
                      .data = {}};
  const std::size_t payload = frame.remote ? 0 : 2 * frame.payload().size();
  if (line.size() != header + payload && line.size() != header + payload + time_stamp) return {};
  if (!parse_hex(line.subspan(header + payload))) return {};
  for (std::size_t i = 0; i < payload / 2; ++i) {
    const auto byte = parse_hex(line.subspan(header + 2 * i, 2));
    if (!byte) return {};
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return frame;
}

}  // namespace

EncodedFrame::EncodedFrame(const hal::CanFrame& frame) noexcept {
  text_[size_++] = frame.remote ? 'r' : 't';
  append_hex(frame.id & 0x7FFU, 3);
  append_hex(static_cast<std::uint32_t>(frame.payload().size()), 1);
  if (!frame.remote)
    for (const std::uint8_t byte : frame.payload()) append_hex(byte, 2);
  text_[size_++] = carriage_return;
}

void EncodedFrame::append_hex(std::uint32_t value, unsigned digits) noexcept {
  constexpr std::array<char, 16> hex{'0', '1', '2', '3', '4', '5', '6', '7', '8', '9', 'A', 'B', 'C', 'D', 'E', 'F'};
  while (digits-- > 0) text_[size_++] = hex[value >> (4 * digits) & 0xFU];
}

std::optional<char> bit_rate_digit(std::uint32_t bit_rate) noexcept {
  constexpr std::array<std::uint32_t, 9> rates{10'000,  20'000,  50'000,  100'000,  125'000,
                                               250'000, 500'000, 800'000, 1'000'000};
  for (std::size_t i = 0; i < rates.size(); ++i) {
    if (rates[i] == bit_rate) return static_cast<char>('0' + i);
  }
  return {};
}

std::optional<Message> Decoder::take(char character) noexcept {
  if (character == carriage_return) return finish_line();
  if (character == bell) {
    size_ = 0;
    return Message{.kind = Message::Kind::refused};
  }
  if (size_ < line_.size()) line_[size_] = character;
  if (size_ <= line_.size()) ++size_;
  return {};
}

Message Decoder::finish_line() noexcept {
  using Kind = Message::Kind;
  const std::size_t size = size_;
  size_ = 0;
  if (size > line_.size()) return {.kind = Kind::malformed};
  if (size == 0) return {.kind = Kind::done};
  const auto line = std::span<const char>{line_}.first(size);
  switch (line[0]) {
    case 't':
    case 'r': {
      const auto frame = parse_frame(line);
      return frame ? Message{.kind = Kind::frame, .status = 0, .frame = *frame} : Message{.kind = Kind::malformed};
    }
    case 'F': {
      const auto flags = parse_hex(line.subspan(1));
      if (size != 3 || !flags) return {.kind = Kind::malformed};
      return {.kind = Kind::status, .status = static_cast<std::uint8_t>(*flags)};
    }
    case 'z':
      return {.kind = size == 1 ? Kind::taken : Kind::malformed};
    case 'T':
    case 'R':
    case 'V':
    case 'N':
      return {.kind = Kind::unknown};
    default:
      return {.kind = Kind::malformed};
  }
}

}  // namespace breakaway::slcan
