#include "breakaway/evaluation/record_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <vector>

#include "breakaway/input/input_error.hpp"

namespace breakaway::evaluation {
namespace {

std::string_view next_of(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> fields;
  do {
    const bool last = line.find(',') == line.npos;
    fields.push_back(next_of(line, ','));
    if (last) break;
  } while (true);
  return fields;
}

struct Columns {
  std::size_t time, position, command;
  std::optional<std::size_t> axis;
};

Columns columns_of(std::string_view head) {
  const std::vector<std::string_view> names = fields_of(head);
  const auto place = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) return {};
    return static_cast<std::size_t>(found - names.begin());
  };
  const auto require = [&](std::string_view name) {
    if (const auto found = place(name)) return *found;
    throw InputError{fmt::format(
        "line 1 has no column {}: give a record of `breakaway-node --csv` or `breakaway identify --csv`", name)};
  };
  return {require("time_s"), require("position_m"), require("command_N"), place("axis")};
}

double number(const std::vector<std::string_view>& fields, std::size_t column, std::size_t line) {
  double value = NAN;
  if (column < fields.size())
    std::from_chars(fields[column].data(), fields[column].data() + fields[column].size(), value);
  if (std::isfinite(value)) return value;
  throw InputError{fmt::format("line {}: column {} is not a number; was the record cut off?", line, column + 1)};
}

// Fills up the periods that the time jumps over.
void append(Record& record, double passed_s, const Reading& reading) {
  constexpr double longest_gap = 1000;
  const double periods = std::round(passed_s / record.period_s);
  if (periods > longest_gap) record.readings.clear();  // another run
  for (double i = 1; i < std::min(periods, longest_gap); ++i) {
    Reading missing = reading;
    missing.fresh = false;
    record.readings.push_back(missing);
  }
  record.readings.push_back(reading);
}

}  // namespace

Record record_of_csv(std::string_view text, const RecordUnits& units) {
  Record record{units.period_s, units.resolution_m, units.force_step_N, {}};
  const Columns columns = columns_of(next_of(text, '\n'));
  std::optional<double> before_s;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::vector<std::string_view> fields = fields_of(next_of(text, '\n'));
    if (fields.size() == 1 && fields.front().empty()) continue;
    if (columns.axis && !units.axis.empty() && (fields.size() <= *columns.axis || fields[*columns.axis] != units.axis))
      continue;
    const double time_s = number(fields, columns.time, line);
    if (before_s && time_s <= *before_s)
      throw InputError{fmt::format(
          "line {}: time_s does not grow; give one run of one axis, and of a node with several name it by --axis",
          line)};
    append(record, before_s ? time_s - *before_s : units.period_s,
           {number(fields, columns.position, line), number(fields, columns.command, line), true});
    before_s = time_s;
  }
  return record;
}

std::string to_csv(const Record& record) {
  std::string text = "time_s,position_m,command_N\n";
  for (std::size_t i = 0; i < record.readings.size(); ++i) {
    const Reading& reading = record.readings[i];
    if (!reading.fresh) continue;
    fmt::format_to(std::back_inserter(text), "{:.6f},{:.10g},{:.8g}\n", static_cast<double>(i) * record.period_s,
                   reading.position_m, reading.command_N);
  }
  return text;
}

}  // namespace breakaway::evaluation
