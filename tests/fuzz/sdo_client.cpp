// Whatever a server answers, and whenever, the SDO client stays inside its buffer, reports only what its contract
// lists, and is free again once the time limit has passed.
#include <fuzzer/FuzzedDataProvider.h>
#include <breakaway/canopen/cob_id.hpp>
#include <breakaway/canopen/sdo_client.hpp>
#include <vector>

#include "require.hpp"

namespace {

using breakaway::canopen::SdoClient;
using breakaway::canopen::SdoResult;
using breakaway::canopen::SdoStart;
using breakaway::fuzz::require;
using breakaway::hal::CanFrame;
using breakaway::hal::Duration;
using breakaway::hal::Time;

constexpr std::uint8_t node_id = 5;
constexpr std::uint16_t response_id = breakaway::canopen::sdo_response_cob_id(node_id);
constexpr Duration time_limit{1000};

void start(SdoClient& client, FuzzedDataProvider& input) {
  const auto index = input.ConsumeIntegral<std::uint16_t>();
  const auto subindex = input.ConsumeIntegral<std::uint8_t>();
  if (input.ConsumeBool()) {
    require(client.start_read(index, subindex) == SdoStart::started);
    return;
  }
  const auto size = input.ConsumeIntegralInRange<std::size_t>(0, 2 * SdoClient::capacity);
  const std::vector<std::uint8_t> bytes = input.ConsumeBytes<std::uint8_t>(size);
  const bool fits = !bytes.empty() && bytes.size() <= SdoClient::capacity;
  require(client.start_write(index, subindex, bytes) == (fits ? SdoStart::started : SdoStart::bad_length));
}

// The command byte of a server that keeps to CiA 301 (7.2.4.3): without it no input would get past the first segments.
std::uint8_t proper_command(FuzzedDataProvider& input, std::uint8_t request) {
  const unsigned toggle = request & 0x10U;
  switch (request >> 5U) {
    case 0:  // write segment
      return static_cast<std::uint8_t>(0x20U | toggle);
    case 1:  // initiate write
      return 0x60;
    case 2:  // initiate read: segmented, its size unknown
      return 0x40;
    default:  // read segment: any length, now and then the last
      return static_cast<std::uint8_t>(toggle | input.ConsumeIntegralInRange(0U, 3U) << 1U |
                                       (input.ConsumeProbability<float>() < 0.05F ? 1U : 0U));
  }
}

CanFrame answer(FuzzedDataProvider& input, const CanFrame& request) {
  CanFrame frame{.id = response_id, .size = 8, .remote = false, .data = request.data};
  frame.data[0] = proper_command(input, request.data[0]);
  if (input.ConsumeProbability<float>() < 0.9F) return frame;

  if (input.ConsumeBool()) frame.id = input.ConsumeIntegral<std::uint16_t>();
  if (input.ConsumeBool()) frame.size = input.ConsumeIntegral<std::uint8_t>();
  if (input.ConsumeBool()) frame.remote = true;
  if (input.ConsumeBool()) frame.data[0] = input.ConsumeIntegral<std::uint8_t>();
  const auto first_wrong = input.ConsumeIntegralInRange<std::size_t>(1, frame.data.size());
  for (std::size_t i = first_wrong; i < frame.data.size(); ++i) frame.data[i] = input.ConsumeIntegral<std::uint8_t>();
  return frame;
}

// A finished transfer says how it ended, and why where there is a why.
void check_result(const SdoClient& client, SdoResult result) {
  require((result == SdoResult::busy) == client.busy());
  require(breakaway::canopen::to_string(result) != "unknown result");
  if (result == SdoResult::protocol_error) require(client.unexpected_command() >> 5U != 4);  // an abort is no error
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  FuzzedDataProvider input(bytes, count);
  SdoClient client(node_id, time_limit);
  CanFrame request;
  Time now{};
  while (input.remaining_bytes() > 0) {
    if (!client.busy()) start(client, input);
    if (client.next_frame(request, now))
      require(request.id == breakaway::canopen::sdo_request_cob_id(node_id) && request.size == 8);
    client.on_frame(answer(input, request));
    now += Duration{input.ConsumeIntegralInRange<int>(0, 300)};
    check_result(client, client.poll(now));
    require(client.data().size() <= SdoClient::capacity);
  }
  client.next_frame(request, now);
  require(client.poll(now + time_limit + time_limit) != SdoResult::busy);
  return 0;
}
