// Whatever a client asks, and in whatever order, the SDO server gives at most one answer to a request, of its own id
// and eight bytes; the segments of a text are the text, byte by byte; and it writes only what a request carried.
#include <fuzzer/FuzzedDataProvider.h>

#include <algorithm>
#include <breakaway/canopen/bytes.hpp>
#include <breakaway/canopen/cob_id.hpp>
#include <breakaway/canopen/sdo_server.hpp>

#include "require.hpp"

namespace {

using breakaway::canopen::ObjectAddress;
using breakaway::canopen::ObjectType;
using breakaway::canopen::ObjectValue;
using breakaway::canopen::SdoAbort;
using breakaway::canopen::SdoServer;
using breakaway::fuzz::require;
using breakaway::hal::CanFrame;

constexpr std::uint8_t node_id = 5;
constexpr std::string_view text = "a text that is longer than one segment, and than two";

// The kind of an object is in its index: refused, a number of 1 to 4 bytes, or a text of any length.
struct Dictionary {
  ObjectValue read(ObjectAddress address) noexcept {
    if (address.index % 4 == 0) return {.abort = SdoAbort::no_such_object};
    if (address.index % 4 == 1) return {.text = text_of(address)};
    const auto type = static_cast<ObjectType>(1 + address.subindex % 4);
    return {.type = type, .number = 0xA1B2C3D4U};
  }
  SdoAbort write(ObjectAddress address, std::span<const std::uint8_t> bytes) noexcept {
    require(bytes.size() <= 4 && address.index % 4 != 0);
    written = true;
    return address.subindex < 128 ? SdoAbort::none : SdoAbort::read_only;
  }
  static std::string_view text_of(ObjectAddress address) {
    return text.substr(0, address.subindex % (text.size() + 1));
  }

  bool written = false;
};

// What a client that keeps to CiA 301 would ask next; without it no text would be read to its end.
class Client {
 public:
  CanFrame next(FuzzedDataProvider& input) {
    CanFrame request{.id = breakaway::canopen::sdo_request_cob_id(node_id), .size = 8, .remote = false, .data = {}};
    if (left_ > 0 && input.ConsumeProbability<float>() < 0.9F) {
      request.data[0] = static_cast<std::uint8_t>(0x60U | toggle_);
      return request;
    }
    constexpr std::array<std::uint8_t, 8> commands{0x40, 0x40, 0x40, 0x22, 0x23, 0x2F, 0x21, 0x80};
    request.data[0] = input.ConsumeBool() ? input.PickValueInArray(commands) : input.ConsumeIntegral<std::uint8_t>();
    breakaway::canopen::store_little_endian(request.data, input.ConsumeIntegral<std::uint16_t>(), 1);
    for (std::size_t i = 3; i < 8; ++i) request.data[i] = input.ConsumeIntegral<std::uint8_t>();
    return request;
  }

  void check(const CanFrame& request, const CanFrame& answer) {
    const unsigned kind = answer.data[0] >> 5U;
    if (kind == 2U) begin(request, answer);
    if (kind == 0U) take_segment(answer);
    if (kind != 0U && kind != 2U) left_ = 0;
  }

 private:
  void begin(const CanFrame& request, const CanFrame& answer) {
    left_ = 0;
    if ((answer.data[0] & 2U) != 0) return;
    expected_ =
        Dictionary::text_of({breakaway::canopen::load_little_endian<std::uint16_t>(request.data, 1), request.data[3]});
    require(breakaway::canopen::load_little_endian<std::uint32_t>(answer.data, 4) == expected_.size());
    left_ = expected_.size() + 1;  // an empty text has one segment, too
    toggle_ = 0;
  }
  void take_segment(const CanFrame& answer) {
    require(left_ > 0);
    const std::size_t count = 7U - ((answer.data[0] >> 1U) & 7U);
    require((answer.data[0] & 0x10U) == toggle_ && count <= expected_.size());
    require(
        std::equal(expected_.begin(), expected_.begin() + static_cast<std::ptrdiff_t>(count), answer.data.begin() + 1));
    expected_.remove_prefix(count);
    toggle_ ^= 0x10U;
    const bool last = (answer.data[0] & 1U) != 0;
    require(last == expected_.empty());
    left_ = last ? 0 : expected_.size();
  }

  std::string_view expected_;
  std::size_t left_ = 0;  // of a text that is being read
  unsigned toggle_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  FuzzedDataProvider input(bytes, count);
  SdoServer server{node_id};
  Dictionary dictionary;
  Client client;
  while (input.remaining_bytes() > 0) {
    CanFrame request = client.next(input);
    if (input.ConsumeProbability<float>() > 0.95F) {
      request.size = input.ConsumeIntegral<std::uint8_t>();
      request.remote = input.ConsumeBool();
      request.id = input.ConsumeBool() ? request.id : input.ConsumeIntegral<std::uint16_t>();
    }
    const bool ours = request.id == breakaway::canopen::sdo_request_cob_id(node_id) && !request.remote;
    require(server.on_frame(request) == ours);
    dictionary.written = false;
    CanFrame answer;
    if (!server.next_frame(answer, dictionary)) {
      require(!dictionary.written);
      continue;
    }
    require(ours && request.size == 8);
    require(answer.id == breakaway::canopen::sdo_response_cob_id(node_id) && answer.size == 8 && !answer.remote);
    require(!dictionary.written || request.data[0] >> 5U == 1U);
    client.check(request, answer);
    require(!server.next_frame(answer, dictionary));
  }
  return 0;
}
