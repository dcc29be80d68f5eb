#include "breakaway/evaluation/record_csv.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
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

std::string_view without_blanks(std::string_view field) {
  constexpr std::string_view blanks = " \t";
  field.remove_prefix(std::min(field.find_first_not_of(blanks), field.size()));
  field.remove_suffix(field.size() - std::min(field.find_last_not_of(blanks) + 1, field.size()));
  return field;
}

std::vector<std::string_view> fields_of(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> fields;
  do {
    const bool last = line.find(',') == line.npos;
    fields.push_back(without_blanks(next_of(line, ',')));
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
    if (std::find(found + 1, names.end(), name) != names.end())
      throw InputError{fmt::format("line 1 has more than one column {}: leave in the one of this axis", name)};
    return static_cast<std::size_t>(found - names.begin());
  };
  const auto require = [&](std::string_view name) {
    if (const auto found = place(name)) return *found;
    throw InputError{fmt::format(
        "line 1 has no column {}: name time_s, position_m and command_N there, as `breakaway-node --csv` does", name)};
  };
  return {require("time_s"), require("position_m"), require("command_N"), place("axis")};
}

// One line of the record.
struct Row {
  std::size_t line;
  double time_s;
  Reading reading;
};

double number(const std::vector<std::string_view>& fields, std::size_t column, std::size_t line) {
  if (column >= fields.size())
    throw InputError{fmt::format("line {}: column {} is not there; was the record cut off?", line, column + 1)};
  std::string_view field = fields[column];
  // std::from_chars() takes no plus sign.
  if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
  double value = NAN;
  const char* const end = field.data() + field.size();
  const bool whole = std::from_chars(field.data(), end, value).ptr == end;
  if (whole && std::isfinite(value)) return value;
  throw InputError{fmt::format(
      "line {}: column {} is not a number alone; leave units out, which the head names; or was the record cut off?",
      line, column + 1)};
}

double position_m(const std::vector<std::string_view>& fields, std::size_t column, std::size_t line,
                  double resolution_m) {
  constexpr double most_counts = 4294967296;  // 32 bits, which the places of an axis are not further apart than
  const double position_m = number(fields, column, line);
  if (std::abs(position_m) <= most_counts * resolution_m) return position_m;
  throw InputError{
      fmt::format("line {}: column {} is {:.4g} m, which is more than 32 bits count in steps of {:g} m: give it in "
                  "metres, and check [drive] encoder_resolution_m",
                  line, column + 1, position_m, resolution_m)};
}

double command_N(const std::vector<std::string_view>& fields, std::size_t column, std::size_t line,
                 double max_force_N) {
  constexpr double rounding = 1.01;
  const double command_N = number(fields, column, line);
  if (std::abs(command_N) <= rounding * max_force_N) return command_N;
  throw InputError{fmt::format(
      "line {}: column {} is {:.4g} N, and the [drive] gives {:.4g} N at most: give it in newtons, and check [drive]",
      line, column + 1, command_N, max_force_N)};
}

// Collects the rows of the axis that is wanted.
class Reader {
 public:
  Reader(const Columns& columns, const RecordUnits& units) : columns_{columns}, units_{units} {}

  void read(std::string_view text, std::size_t line) {
    const std::vector<std::string_view> fields = fields_of(text);
    if (fields.size() == 1 && fields.front().empty()) return;
    if (!is_wanted(fields)) return;
    const double time_s = number(fields, columns_.time, line);
    if (!rows_.empty() && time_s <= rows_.back().time_s)
      throw InputError{fmt::format(
          "line {}: time_s does not grow; give one run of one axis, and of a node with several name it by --axis",
          line)};
    rows_.push_back({line,
                     time_s,
                     {position_m(fields, columns_.position, line, units_.resolution_m),
                      command_N(fields, columns_.command, line, units_.max_force_N), true}});
  }

  // Throws where lines name axes, and none the wanted one.
  const std::vector<Row>& rows() const {
    if (!rows_.empty() || others_.empty()) return rows_;
    throw InputError{
        fmt::format("no line has {} in its column axis, which names {}: the file must call the axis as the record does",
                    units_.axis, fmt::join(others_, ", "))};
  }

 private:
  bool is_wanted(const std::vector<std::string_view>& fields) {
    if (!columns_.axis || units_.axis.empty()) return true;
    if (fields.size() <= *columns_.axis) return false;
    const std::string_view axis = fields[*columns_.axis];
    if (axis != units_.axis) remember(axis);
    return axis == units_.axis;
  }
  void remember(std::string_view axis) {
    constexpr std::size_t most_shown = 8;
    std::string shown{axis};
    std::ranges::replace_if(
        shown, [](unsigned char c) { return c < ' '; }, '?');
    if (others_.size() < most_shown && std::ranges::find(others_, shown) == others_.end()) others_.push_back(shown);
  }

  const Columns& columns_;
  const RecordUnits& units_;
  std::vector<Row> rows_;
  std::vector<std::string> others_;  // axes that lines name
};

// Accelerations go with the square of the period, so that a record of half the period would make the mass four times as
// great. Most lines follow one another by one period, whatever was lost.
void require_period(const std::vector<Row>& rows, double period_s) {
  constexpr double most_off = 0.02, rounding_s = 0.5e-6;  // times are written to whole microseconds
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < rows.size(); ++i) steps_s.push_back(rows[i].time_s - rows[i - 1].time_s);
  if (steps_s.empty()) return;
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>((steps_s.size() - 1) / 2);
  std::ranges::nth_element(steps_s, middle);
  if (std::abs(*middle - period_s) <= most_off * period_s + rounding_s) return;
  throw InputError{
      fmt::format("the lines are {:.4g} s apart and [loop] period_s is {:g}: set period_s to what the record was made "
                  "at, or record every period at that of the file; time_s is in seconds",
                  *middle, period_s)};
}

// Fills up the periods that the time jumps over. So many in a row are no samples that were lost.
void append(Record& record, double passed_s, const Row& row) {
  constexpr double longest_gap = 1000;
  const double periods = std::round(passed_s / record.period_s);
  if (periods > longest_gap)
    throw InputError{fmt::format(
        "line {}: time_s jumps by {:.4g} s, more than {:g} periods, so that another run begins there: give one run, "
        "the lines before or those from there on",
        row.line, passed_s, longest_gap)};
  for (double i = 1; i < periods; ++i) {
    Reading missing = row.reading;
    missing.fresh = false;
    record.readings.push_back(missing);
  }
  record.readings.push_back(row.reading);
}

}  // namespace

Record record_of_csv(std::string_view text, const RecordUnits& units) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  const Columns columns = columns_of(next_of(text, '\n'));
  Reader reader{columns, units};
  for (std::size_t line = 2; !text.empty(); ++line) reader.read(next_of(text, '\n'), line);
  const std::vector<Row>& rows = reader.rows();
  require_period(rows, units.period_s);
  Record record{units.period_s, units.resolution_m, units.force_step_N, {}};
  for (std::size_t i = 0; i < rows.size(); ++i)
    append(record, i > 0 ? rows[i].time_s - rows[i - 1].time_s : units.period_s, rows[i]);
  return record;
}

std::string to_csv(const Record& record) {
  std::string text = "time_s,position_m,command_N\n";
  for (std::size_t i = 0; i < record.readings.size(); ++i) {
    const Reading& reading = record.readings[i];
    if (!reading.fresh) continue;
    fmt::format_to(std::back_inserter(text), "{:.6f},{:.12g},{:.8g}\n", static_cast<double>(i) * record.period_s,
                   reading.position_m, reading.command_N);
  }
  return text;
}

}  // namespace breakaway::evaluation
