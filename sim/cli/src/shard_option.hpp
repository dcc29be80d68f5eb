// --shard i/n: which part of a long computation this call does.
#pragma once

#include <fmt/format.h>

#include <string>

#include "breakaway/input/input_error.hpp"
#include "breakaway/study/shard.hpp"
#include "plane_option.hpp"

namespace breakaway::cli {

// Throws InputError.
inline study::Shard read_shard(const std::string& text) {
  const auto shard = two_integers(text, '/');
  if (!shard || (*shard)[1] < 1 || (*shard)[0] < 0 || (*shard)[0] > (*shard)[1])
    throw InputError{fmt::format("--shard {}: give i/n with n >= 1 and i from 1 to n; 0 is the same as n", text)};
  return {(*shard)[0], (*shard)[1]};
}

}  // namespace breakaway::cli
