#include "values.hpp"

#include <fmt/format.h>

namespace breakaway::eds {
namespace {

std::string plain_text(std::int64_t number, int hexadecimal_digits) {
  return hexadecimal_digits > 0 ? fmt::format("0x{:0{}X}", number, hexadecimal_digits) : std::to_string(number);
}

}  // namespace

std::optional<std::string> value_text(const NumberUnderIds& number) {
  if (number.first == number.second) return plain_text(number.first, number.hexadecimal_digits);
  if (number.second - number.first != number.second_id - number.first_id) return std::nullopt;
  return "$NODEID+" + plain_text(number.first - number.first_id, number.hexadecimal_digits);
}

}  // namespace breakaway::eds
