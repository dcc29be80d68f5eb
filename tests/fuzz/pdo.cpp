// A mapping that a node reports may be nonsense: packing and unpacking stay inside the frame, and what fits a PDO comes
// back as it was sent.
#include <fuzzer/FuzzedDataProvider.h>
#include <breakaway/canopen/pdo.hpp>
#include <cstdlib>

namespace {

using breakaway::canopen::PdoMapping;
using Values = std::array<std::uint64_t, PdoMapping::max_objects>;

void require(bool condition) {
  if (!condition) std::abort();
}

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  FuzzedDataProvider input(bytes, count);
  const PdoMapping mapping = any_mapping(input);
  Values sent{};
  for (auto& value : sent) value = input.ConsumeIntegral<std::uint64_t>();

  const auto frame = breakaway::canopen::pack_pdo(mapping, sent);
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
    require(received[i] == (sent[i] & mask));
  }
  return 0;
}
