// A mapping that a node reports may be nonsense: packing and unpacking stay inside the frame, and what fits a PDO comes
// back as it was sent.
#include <fuzzer/FuzzedDataProvider.h>
#include <breakaway/canopen/pdo.hpp>

#include "require.hpp"

namespace {

using breakaway::canopen::PdoMapping;
using breakaway::fuzz::require;
using breakaway::hal::CanFrame;
using Values = std::array<std::uint64_t, PdoMapping::max_objects>;

PdoMapping any_mapping(FuzzedDataProvider& input) {
  PdoMapping mapping;
  mapping.cob_id = input.ConsumeIntegral<std::uint32_t>();
  mapping.count = input.ConsumeIntegralInRange<std::uint8_t>(0, 12);
  const bool valid = input.ConsumeBool();
  for (auto& object : mapping.objects) {
    object.bits = valid ? input.ConsumeIntegralInRange<std::uint8_t>(1, 8) : input.ConsumeIntegral<std::uint8_t>();
  }
  return mapping;
}

// What is no PDO of that mapping is not taken and writes nothing, and no more is written than there is room for.
void check_foreign(FuzzedDataProvider& input, const PdoMapping& mapping, CanFrame frame) {
  const std::size_t room = input.ConsumeIntegralInRange<std::size_t>(0, Values{}.size());
  frame.id ^= input.ConsumeBool() ? input.ConsumeIntegral<std::uint16_t>() : 0;
  frame.remote = input.ConsumeBool();
  frame.size = input.ConsumeIntegral<std::uint8_t>();
  constexpr std::uint64_t untouched = 0x5A5A'5A5A'5A5A'5A5A;
  Values received{};
  received.fill(untouched);
  const bool taken = breakaway::canopen::unpack_pdo(mapping, frame, std::span{received}.first(room));
  const bool ours = frame.id == (mapping.cob_id & CanFrame::max_id) && !frame.remote;
  require(!taken || (ours && frame.payload().size() >= mapping.size_bytes()));
  for (std::size_t i = taken ? room : 0; i < received.size(); ++i) require(received[i] == untouched);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  FuzzedDataProvider input(bytes, count);
  const PdoMapping mapping = any_mapping(input);
  Values sent{};
  for (auto& value : sent) value = input.ConsumeIntegral<std::uint64_t>();

  const std::size_t given =
      input.ConsumeBool() ? sent.size() : input.ConsumeIntegralInRange<std::size_t>(0, sent.size());
  const auto frame = breakaway::canopen::pack_pdo(mapping, std::span{sent}.first(given));
  require(frame.size <= frame.data.size());

  Values received{};
  const bool taken = breakaway::canopen::unpack_pdo(mapping, frame, received);
  if (mapping.size_bytes() > frame.data.size()) {
    require(!taken);
    return 0;
  }
  require(taken);
  for (std::size_t i = 0; i < mapping.mapped().size(); ++i) {
    const unsigned bits = mapping.objects[i].bits;
    const std::uint64_t mask = bits < 64 ? (std::uint64_t{1} << bits) - 1 : ~std::uint64_t{0};
    require(received[i] == (i < given ? sent[i] & mask : 0));
  }
  check_foreign(input, mapping, frame);
  return 0;
}
