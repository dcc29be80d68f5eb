// Whatever a driver puts into a frame, payload() stays inside its data.
#include <breakaway/hal/can_frame.hpp>
#include <cstdint>
#include <cstdlib>
#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  breakaway::hal::CanFrame frame;
  if (count == 0 || count > 1 + frame.data.size()) return 0;
  frame.size = bytes[0];
  std::memcpy(frame.data.data(), bytes + 1, count - 1);

  const auto payload = frame.payload();
  const bool inside = payload.data() == frame.data.data() && payload.size() <= frame.data.size();
  const bool complete = frame.size > frame.data.size() || payload.size() == frame.size;
  if (!inside || !complete) std::abort();
  return 0;
}
