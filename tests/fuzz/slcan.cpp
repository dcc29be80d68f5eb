// An adapter may say anything: the port neither reads nor writes outside its buffers, every frame that it makes of it
// is a classic one, and once the adapter is in its senses again the port opens it.
#include <fuzzer/FuzzedDataProvider.h>
#include <breakaway/slcan/port.hpp>
#include <cstdlib>
#include <string>

namespace {

using breakaway::hal::BusState;
using breakaway::hal::ReceivedFrame;
using breakaway::hal::Time;
using std::chrono::milliseconds;

void require(bool condition) {
  if (!condition) std::abort();
}

struct Wire {
  bool read(char& character) noexcept {
    if (next == to_port.size()) return false;
    character = to_port[next++];
    return true;
  }
  bool write(std::span<const char> text) noexcept {
    from_port.append(text.data(), text.size());
    return true;
  }
  std::string to_port, from_port;
  std::size_t next = 0;
};

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
    port.flush(now);
  };
  while (input.remaining_bytes() > 0) {
    wire.to_port += input.ConsumeBool() ? "\r" : input.ConsumeRandomLengthString(40);
    period();
  }
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
