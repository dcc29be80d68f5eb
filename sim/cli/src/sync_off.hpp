// A certificate says what it takes in of the bus, and a run may have seen otherwise.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "breakaway/config/node.hpp"

namespace breakaway::cli {

// Of a certified axis, a line that begins with `head`; nothing where SYNC came as the file tells.
inline void print_sync_off(std::string_view head, const config::Axis& axis, double sync_off_s) {
  const double told_s = axis.uncertainty.jitter_s;
  if (sync_off_s <= told_s + 1e-9) return;
  fmt::print(
      "{}off whole periods by up to {:.3g} s behind frames of somebody else, which the certificate does not take in: "
      "have them sent in whole periods, or under the coast \"brake\" without [move] raise [uncertainty] jitter_s = "
      "{:g}\n",
      head, sync_off_s, told_s);
}

}  // namespace breakaway::cli
