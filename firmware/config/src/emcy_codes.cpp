#include "emcy_codes.hpp"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace breakaway::config {
namespace {

constexpr std::size_t code_digits = 4;

struct Codes {
  std::uint16_t first, last;
};

std::optional<std::uint32_t> hexadecimal_number(std::string_view digits) {
  std::uint32_t number = 0;
  const char* const end = digits.data() + digits.size();
  const auto [rest, error] = std::from_chars(digits.data(), end, number, 16);
  if (rest != end || error == std::errc::invalid_argument) return std::nullopt;
  return error == std::errc{} ? number : std::numeric_limits<std::uint32_t>::max();
}

// Returns nothing for what is no code and no class. A number of more than four digits is one that no code can be.
std::optional<Codes> codes_of(std::string_view text, const Entry& entry) {
  if (!text.ends_with('h')) return std::nullopt;
  const std::string_view number = text.substr(0, text.size() - 1);
  const bool is_class = number.size() == code_digits && number.ends_with("xx");
  const auto value = hexadecimal_number(is_class ? number.substr(0, 2) : number);
  if (!value) return std::nullopt;
  if (*value > 0xFFFF)
    entry.parent.fail(entry.key, fmt::format("has \"{}\", which is above FFFFh, the last error code of EMCY; give it "
                                             "four digits",
                                             text));
  if (number.size() != code_digits) return std::nullopt;
  const auto first = static_cast<std::uint16_t>(is_class ? *value << 8 : *value);
  if (first < 0x100)
    entry.parent.fail(
        entry.key, fmt::format("has \"{}\", and 00xxh is how a drive says that errors are gone; leave it out", text));
  return Codes{first, static_cast<std::uint16_t>(is_class ? first | 0xFF : first)};
}

std::string code_text(Codes codes) {
  return codes.first == codes.last ? fmt::format("{:04X}h", codes.first) : fmt::format("{:02X}xxh", codes.first >> 8);
}

// What the file says twice is a mistake in one of the two places.
void require_apart(Codes codes, Codes other, const Entry& entry) {
  if (codes.first > other.last || other.first > codes.last) return;
  const bool is_same = codes.first == other.first && codes.last == other.last;
  const bool holds_other = codes.first <= other.first && other.last <= codes.last;
  const Codes &wide = holds_other ? codes : other, &narrow = holds_other ? other : codes;
  entry.parent.fail(entry.key, is_same ? fmt::format("has \"{}\" twice; leave one out", code_text(codes))
                                       : fmt::format("has \"{}\", which \"{}\" holds as well; leave one of the two out",
                                                     code_text(narrow), code_text(wide)));
}

bool take_codes(canopen::EmcyCodes& to, const toml::array& array, const Entry& entry) {
  if (array.size() > canopen::EmcyCodes::most)
    entry.parent.fail(entry.key, fmt::format("has {} entries, and a drive has room for {}; name a class, as \"FFxxh\", "
                                             "in the place of several of its codes",
                                             array.size(), canopen::EmcyCodes::most));
  std::size_t count = 0;
  for (const toml::node& node : array) {
    const auto text = node.value_exact<std::string_view>();
    const auto codes = text ? codes_of(*text, entry) : std::nullopt;
    if (!codes) return false;
    for (std::size_t i = 0; i < count; ++i) require_apart(*codes, {to.first[i], to.last[i]}, entry);
    to.first[count] = codes->first;
    to.last[count++] = codes->last;
  }
  return true;
}

}  // namespace

Value emcy_codes(canopen::EmcyCodes& to) {
  return {.expects = "an array of error codes of EMCY in quotes, each as \"FF01h\", or \"42xxh\" for a whole class",
          .take =
              [&to](const Entry& entry) {
                const toml::array* array = entry.node.as_array();
                return array != nullptr && take_codes(to, *array, entry);
              },
          .form = {.type = Form::Type::array,
                   .parts = {{.type = Form::Type::text, .pattern = "^[0-9A-Fa-f]{2}([0-9A-Fa-f]{2}|xx)h$"}},
                   .most_entries = canopen::EmcyCodes::most}};
}

}  // namespace breakaway::config
