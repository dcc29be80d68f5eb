// Reads what `breakaway-node --stream` sends: a datagram is one flat JSON object of numbers, one sample of one axis.
// The fields are described where they are written, in firmware/targets/linux/sample_stream.hpp.
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/watch/sample.hpp"

namespace breakaway::watch {

struct Datagram {
  Sample sample;
  std::uint64_t number = 0;   // of the datagram in its run
  std::uint64_t dropped = 0;  // samples that were not sent until then
};

// Throws InputError, for any bytes that are no such object: the text says what is wrong with it.
Datagram read_datagram(std::string_view text);

}  // namespace breakaway::watch
