// An adapter may say anything: the port neither reads nor writes outside its buffers, every frame that it makes of it
// is a classic one, and once the adapter is in its senses again the port opens it.
#include <fuzzer/FuzzedDataProvider.h>
#include <algorithm>
#include <breakaway/slcan/codec.hpp>
#include <breakaway/slcan/port.hpp>
#include <string>

#include "require.hpp"

namespace {

using breakaway::fuzz::require;
using breakaway::hal::BusState;
using breakaway::hal::CanFrame;
using breakaway::hal::ReceivedFrame;
using breakaway::hal::Time;
using std::chrono::milliseconds;

struct Wire {
  bool read(char& character) noexcept {
    if (next == to_port.size()) return false;
    character = to_port[next++];
    return true;
  }
  bool write(std::span<const char> text) noexcept {
    if (takes) from_port.append(text.data(), text.size());
    return takes;
  }
  std::string to_port, from_port;
  std::size_t next = 0;
  bool takes = true;
};

CanFrame any_frame(FuzzedDataProvider& input) {
  CanFrame frame{.id = input.ConsumeIntegral<std::uint16_t>(), .size = 0, .remote = input.ConsumeBool(), .data = {}};
  frame.size = input.ConsumeIntegralInRange<std::uint8_t>(0, 9);
  for (std::uint8_t& byte : frame.data) byte = input.ConsumeIntegral<std::uint8_t>();
  return frame;
}

// What an adapter says, whole or with a character changed or cut off: no input of bytes would find the way to a frame.
std::string any_line(FuzzedDataProvider& input) {
  switch (input.ConsumeIntegralInRange(0, 3)) {
    case 0:
      return "\r";
    case 1:
      return input.ConsumeRandomLengthString(40);
    case 2:
      return input.PickValueInArray({"\a", "z\r", "F00\r", "F04\r", "F20\r", "F80\r", "V1013\r", "NA123\r"});
    default:
      break;
  }
  CanFrame frame = any_frame(input);
  frame.id &= CanFrame::max_id;
  frame.size = std::min<std::uint8_t>(frame.size, 8);
  const breakaway::slcan::EncodedFrame encoded{frame};
  std::string line{encoded.text().begin(), encoded.text().end()};
  if (input.ConsumeBool()) line.insert(line.size() - 1, "12ab");  // a time stamp
  if (input.ConsumeProbability<float>() > 0.7F)
    line[input.ConsumeIntegralInRange<std::size_t>(0, line.size() - 1)] = input.ConsumeIntegral<char>();
  if (input.ConsumeProbability<float>() > 0.9F) line.resize(input.ConsumeIntegralInRange<std::size_t>(0, line.size()));
  return line;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  FuzzedDataProvider input(bytes, count);
  Wire wire;
  breakaway::slcan::Port<Wire> port{wire, 1'000'000};
  Time now{};
  const auto period = [&] {
    now += milliseconds{1};
    port.poll(now);
    for (ReceivedFrame received; port.receive(received);)
      require(received.frame.id <= 0x7FF && received.frame.size <= 8);
    static_cast<void>(port.send({.id = 0x080}, now));
    if (input.remaining_bytes() > 0) {
      wire.takes = input.ConsumeProbability<float>() < 0.9F;
      const auto frames = input.ConsumeIntegralInRange(0, 3);
      for (int i = 0; i < frames; ++i)
        static_cast<void>(port.send(any_frame(input), now + milliseconds{input.ConsumeIntegralInRange(-1, 3)}));
      if (input.ConsumeProbability<float>() > 0.95F) port.purge_transmit_queue();
    }
    port.flush(now);
  };
  while (input.remaining_bytes() > 0) {
    wire.to_port += any_line(input);
    if (input.ConsumeProbability<float>() < 0.3F) continue;  // several lines in one period
    if (input.ConsumeProbability<float>() < 0.8F) {
      period();
      continue;
    }
    port.poll(now += milliseconds{1});  // nobody receives what came
  }
  wire.takes = true;
  wire.to_port += '\r';  // ends a line that was left open
  for (int i = 0; i < 100; ++i) {
    wire.from_port.clear();
    period();
    const bool asks = wire.from_port.starts_with('S') || wire.from_port.starts_with('O');
    wire.to_port += asks ? "\r" : "F00\r";
  }
  require(port.bus_state() == BusState::error_active);
  return 0;
}
