#include "breakaway/watch/csv_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "breakaway/input/input_error.hpp"

namespace breakaway::watch {
namespace {

std::vector<std::string_view> split(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> parts;
  for (std::size_t comma = 0; comma != line.npos;) {
    comma = line.find(',');
    parts.push_back(line.substr(0, comma));
    if (comma != line.npos) line.remove_prefix(comma + 1);
  }
  return parts;
}

InputError unreadable(std::string_view column, std::string_view text, std::string_view expected) {
  constexpr std::size_t longest = 32;
  return InputError{fmt::format("{} is \"{}\", {}", column, text.substr(0, longest), expected)};
}

double real(std::string_view column, std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) throw unreadable(column, text, "not a number");
  return number;
}

std::uint16_t hexadecimal(std::string_view column, std::string_view text) {
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
  if (error != std::errc{} || end != text.data() + text.size())
    throw unreadable(column, text, "not a hexadecimal number of four digits");
  return number;
}

// "-" stands for what is not known.
template <class Enum>
std::optional<Enum> named(std::string_view column, std::string_view text) {
  if (text == "-") return {};
  const auto found = enumerator<Enum>(text);
  if (!found) throw unreadable(column, text, "a name that breakaway does not give it");
  return found;
}

void put(Sample& sample, std::string_view column, std::string_view text) {
  if (column == "axis") sample.axis = text;
  if (column == "time_s") sample.time_s = real(column, text);
  if (column == "target_m") sample.target_m = real(column, text);
  if (column == "position_m") sample.position_m = real(column, text);
  if (column == "command_N") sample.command_N = real(column, text);
  if (column == "reported_N" || column == "force_N") sample.reported_N = real(column, text);
  if (column == "latency_us") sample.latency_us = real(column, text);
  if (column == "bus_load") sample.bus_load = real(column, text);
  if (column == "mode") sample.mode = named<law::Mode>(column, text);
  if (column == "drive") sample.drive = named<hal::DriveState>(column, text);
  if (column == "fault") sample.fault = named<firmware::AxisFault>(column, text);
  if (column == "fault_code") sample.fault_code = hexadecimal(column, text);
}

}  // namespace

CsvReader::CsvReader(std::string_view header) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (header.starts_with(byte_order_mark)) header.remove_prefix(byte_order_mark.size());
  for (const auto column : split(header)) {
    if (!column.empty() && std::ranges::find(columns_, column) != columns_.end())
      throw InputError{fmt::format("the first line has more than one column {}: leave one of them in", column)};
    columns_.emplace_back(column);
  }
  for (const char* needed : {"time_s", "position_m"}) {
    if (std::ranges::find(columns_, needed) == columns_.end())
      throw InputError{
          fmt::format("the first line has no column {}: give a run that breakaway-node --csv or breakaway "
                      "simulate --csv has written, of axes and not of a [machine]",
                      needed)};
  }
}

Sample CsvReader::read(std::string_view line) const {
  const auto parts = split(line);
  if (parts.size() != columns_.size())
    throw InputError{fmt::format("has {} columns, and the first line names {}", parts.size(), columns_.size())};
  Sample sample;
  for (std::size_t i = 0; i < parts.size(); ++i) put(sample, columns_[i], parts[i]);
  if (!std::isfinite(sample.time_s) || !std::isfinite(sample.position_m))
    throw InputError{"time_s or position_m is not a finite number"};
  return sample;
}

}  // namespace breakaway::watch
