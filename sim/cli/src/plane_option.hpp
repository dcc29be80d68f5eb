// --plane i,j and --window X: which two entries of (q, v) a picture shows, and how far.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include "breakaway/input/input_error.hpp"
#include "breakaway/study/basin.hpp"
#include "commands.hpp"

namespace breakaway::cli {

// "a,b" or "a/b".
inline std::optional<std::array<int, 2>> two_integers(const std::string& text, char between) {
  std::array<int, 2> two{};
  char separator = 0, beyond = 0;
  if (std::sscanf(text.c_str(), "%d%c%d%c", &two[0], &separator, &two[1], &beyond) != 3 || separator != between) {
    return std::nullopt;
  }
  return two;
}

// From 0, in place of 1. Throws InputError.
inline std::array<int, 2> read_plane(const std::string& text, int coordinates) {
  const auto places = two_integers(text, ',');
  const auto valid = [&](int place) { return place >= 1 && place <= 2 * coordinates; };
  if (!places || !valid((*places)[0]) || !valid((*places)[1]) || (*places)[0] == (*places)[1]) {
    throw InputError{fmt::format("--plane {}: give two different places of the state as i,j: 1..{} are q, {}..{} are v",
                                 text, coordinates, coordinates + 1, 2 * coordinates)};
  }
  return {(*places)[0] - 1, (*places)[1] - 1};
}

inline const CLI::Validator window_half_width{
    [](std::string& text) -> std::string {
      double value = 0;
      if (CLI::detail::lexical_cast(text, value) && value > 0 && value <= study::widest_half_width) return "";
      return fmt::format("{} is not a number above 0 and at most {:g}", text, study::widest_half_width);
    },
    ""};

}  // namespace breakaway::cli
