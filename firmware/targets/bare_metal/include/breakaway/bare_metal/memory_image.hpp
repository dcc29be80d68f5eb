// C++ expects before main() that initialised data are copied from flash, that the rest is zero and that constructors
// have run. The linker script of every bare-metal target defines the symbols for it.
#pragma once

#include <algorithm>
#include <cstdint>

extern "C" {
extern const std::uint32_t image_data_source[];
extern std::uint32_t image_data_begin[], image_data_end[], image_zero_begin[], image_zero_end[];
extern void (*const image_constructors_begin[])();
extern void (*const image_constructors_end[])();
}

namespace breakaway::bare_metal {

inline void prepare_memory() noexcept {
  std::copy_n(image_data_source, image_data_end - image_data_begin, image_data_begin);
  std::fill(image_zero_begin, image_zero_end, 0U);
  for (auto constructor = image_constructors_begin; constructor != image_constructors_end; ++constructor)
    (*constructor)();
}

}  // namespace breakaway::bare_metal
