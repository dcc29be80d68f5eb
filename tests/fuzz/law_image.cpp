// Any bytes are a law image or are refused, and a law that was taken gives forces within its own limit at every
// position. The checksum of most inputs is put right, because none would get past it otherwise.
#include <breakaway/law.h>

#include <breakaway/firmware/law_image.hpp>
#include <cmath>
#include <cstring>
#include <vector>

#include "require.hpp"

namespace {

using breakaway::fuzz::require;

void put_checksum(std::vector<std::uint8_t>& image) {
  constexpr std::size_t size = breakaway::firmware::law_image_checksum_bytes;
  if (image.size() < size) return;
  std::uint32_t sum = breakaway::firmware::checksum_of_bytes({image.data(), image.size() - size});
  for (std::size_t i = image.size() - size; i < image.size(); ++i, sum >>= 8U)
    image[i] = static_cast<std::uint8_t>(sum);
}

// One set of functions of the C interface.
struct InFloat {
  using Law = breakaway_law_f;
  using Scalar = float;
  static constexpr auto init = breakaway_law_f_init;
  static constexpr auto update = breakaway_law_f_update;
  static constexpr auto set_target = breakaway_law_f_set_target;
  static constexpr auto reset = breakaway_law_f_reset;
  static constexpr auto status = breakaway_law_f_status;
};
struct InDouble {
  using Law = breakaway_law_d;
  using Scalar = double;
  static constexpr auto init = breakaway_law_d_init;
  static constexpr auto update = breakaway_law_d_update;
  static constexpr auto set_target = breakaway_law_d_set_target;
  static constexpr auto reset = breakaway_law_d_reset;
  static constexpr auto status = breakaway_law_d_status;
};

// Whatever the axis does: it stands, jumps, or is not read.
template <class In>
void run(typename In::Law& law) {
  using Scalar = typename In::Scalar;
  breakaway_law_status status{};
  require(In::status(&law, &status) == BREAKAWAY_OK && std::isfinite(status.max_force_N));
  require(In::set_target(&law, Scalar{0.01F}) == BREAKAWAY_OK);
  for (int i = 0; i < 40; ++i) {
    const Scalar position_m = i < 30 ? Scalar{0} : static_cast<Scalar>(i % 3) * Scalar{1e-3F};
    const Scalar force_N = In::update(&law, position_m, i % 7 != 6);
    require(std::fabs(static_cast<double>(force_N)) <= status.max_force_N * 1.000001);
    if (i == 25) require(In::reset(&law) == BREAKAWAY_OK);
  }
}

template <class In>
void load(const std::vector<std::uint8_t>& image, unsigned axis) {
  typename In::Law law{};
  const int result = In::init(&law, sizeof law, BREAKAWAY_LAW_ABI, image.data(), image.size(), axis);
  require(std::strcmp(breakaway_result_text(result), "unknown result") != 0);
  if (result == BREAKAWAY_OK) return run<In>(law);
  breakaway_law_status status{};
  require(In::status(&law, &status) == BREAKAWAY_NOT_INITIALISED && In::update(&law, 0, true) == 0);
}

}  // namespace

// The last byte says how the bytes before it are read.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  if (count == 0) return 0;
  const unsigned how = bytes[count - 1];
  std::vector<std::uint8_t> image(bytes, bytes + count - 1);
  if ((how & 7U) != 7U) put_checksum(image);
  const unsigned axis = (how >> 4U) & 3U;
  if ((how & 8U) != 0)
    load<InDouble>(image, axis);
  else
    load<InFloat>(image, axis);
  return 0;
}
