#include "breakaway/study/study_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "fingerprint.hpp"

namespace breakaway::study {
namespace {

constexpr std::string_view columns =
    "position_m,velocity_m_s,law,settled,limit_cycle,settling_time_s,final_error_m,overshoot_m,beyond_m,peak_speed_m_s,"
    "lowest_m,highest_m,peak_force_N,kicks,reached,faults";
constexpr std::size_t runs_of_a_part = 4096;

// Levels and the times at which they were reached, and times and names of faults: "a:b;c:d".
std::string line_of(const Start& start, const StudyRun& run) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  const sil::Excursions& e = run.excursions;
  fmt::format_to(out, "{},{},{},{:d},{:d},{},{},{},{},{},{},{},{},{},", start.position_m, start.velocity_m_s, run.place,
                 run.settled, run.limit_cycle, run.settling_time_s, run.final_error_m, e.overshoot_m, e.beyond_m,
                 e.peak_speed_m_s, e.lowest_m, e.highest_m, run.max_force_N, run.kicks);
  for (std::size_t i = 0; i < run.reached.size(); ++i)
    fmt::format_to(out, "{}{}:{}", i > 0 ? ";" : "", run.reached[i].tolerance_m, run.reached[i].time_s);
  text.push_back(',');
  for (std::size_t i = 0; i < run.faults.size(); ++i)
    fmt::format_to(out, "{}{}:{}", i > 0 ? ";" : "", run.faults[i].time_s, run.faults[i].name);
  return fmt::to_string(text);
}

// Takes a line apart from its front on. Whatever does not fit spoils the whole.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_{line} {}

  bool whole() const { return good_ && rest_.empty(); }
  bool more() const { return good_ && !rest_.empty(); }
  std::string_view until(char end) {
    const std::size_t at = rest_.find(end);
    const std::string_view taken = rest_.substr(0, at);
    rest_ = at == std::string_view::npos ? std::string_view{} : rest_.substr(at + 1);
    return taken;
  }
  template <class Value>
  void read(Value& value, char end) {
    const std::string_view text = until(end);
    const auto [next, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    good_ = good_ && error == std::errc{} && next == text.data() + text.size();
  }
  void read(bool& value, char end) {
    const std::string_view text = until(end);
    good_ = good_ && (text == "0" || text == "1");
    value = text == "1";
  }

 private:
  std::string_view rest_;
  bool good_ = true;
};

std::vector<sil::Reached> read_reached(std::string_view text, bool& good) {
  std::vector<sil::Reached> reached;
  for (Fields fields{text}; fields.more();) {
    sil::Reached& one = reached.emplace_back();
    fields.read(one.tolerance_m, ':');
    fields.read(one.time_s, ';');
    good = good && (fields.more() || fields.whole());
  }
  return reached;
}

std::vector<sil::FaultRecord> read_faults(std::string_view text, bool& good) {
  std::vector<sil::FaultRecord> faults;
  for (Fields fields{text}; fields.more();) {
    sil::FaultRecord& one = faults.emplace_back();
    fields.read(one.time_s, ':');
    one.name = fields.until(';');
    good = good && (fields.more() || fields.whole());
  }
  return faults;
}

std::optional<std::pair<Start, StudyRun>> read_line(std::string_view line) {
  Start start;
  StudyRun run;
  sil::Excursions& e = run.excursions;
  Fields fields{line};
  for (double* value : {&start.position_m, &start.velocity_m_s}) fields.read(*value, ',');
  fields.read(run.place, ',');
  fields.read(run.settled, ',');
  fields.read(run.limit_cycle, ',');
  for (double* value : {&run.settling_time_s, &run.final_error_m, &e.overshoot_m, &e.beyond_m, &e.peak_speed_m_s,
                        &e.lowest_m, &e.highest_m, &run.max_force_N})
    fields.read(*value, ',');
  fields.read(run.kicks, ',');
  bool good = true;
  run.reached = read_reached(fields.until(','), good);
  run.faults = read_faults(fields.until('\n'), good);
  if (!good || !fields.whole()) return std::nullopt;
  return std::pair{start, std::move(run)};
}

// The rows of a study while its runs come in, from several tables and in any order.
class Merge {
 public:
  explicit Merge(const StudyOptions& options) : options_{options} {
    for (const Start& start : options.starts) {
      rows_.push_back({start, std::vector<StudyRun>(laws_of_a_row(options))});
      known_.emplace_back(laws_of_a_row(options), false);
    }
  }

  // Empty, or what is wrong with the line.
  std::string take(std::string_view line) {
    auto read = read_line(line);
    // Written anew it must be what was read, so that nothing is lost on the way.
    if (!read || line_of(read->first, read->second) != line) return fmt::format("is no run of the form {}", columns);
    auto& [start, run] = *read;
    if (run.place >= laws_of_a_row(options_)) return "is of a law that this study does not have";
    bool expected = false;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i].start.position_m != start.position_m || rows_[i].start.velocity_m_s != start.velocity_m_s) continue;
      expected = true;
      StudyRun& here = rows_[i].runs[run.place];
      if (known_[i][run.place] && line_of(start, here) != line)
        return "contradicts what another line says of this run; the tables are not of one study";
      here = run;
      here.law = law_name(options_, run.place);
      known_[i][run.place] = true;
    }
    return expected ? "" : "begins where this study does not; give the --start that the tables were made with";
  }

  std::vector<StudyRow> whole() {
    std::size_t missing = 0;
    for (const std::vector<bool>& row : known_) missing += static_cast<std::size_t>(std::ranges::count(row, false));
    if (missing > 0)
      throw InputError{fmt::format("--merge: {} of {} runs are in none of the files; add the missing shards", missing,
                                   known_.size() * laws_of_a_row(options_))};
    return std::move(rows_);
  }

 private:
  const StudyOptions& options_;
  std::vector<StudyRow> rows_;
  std::vector<std::vector<bool>> known_;
};

void read_table(const std::string& path, const std::string& label, Merge& merge) {
  std::ifstream in{path, std::ios::binary};
  if (!in || std::filesystem::is_directory(path))
    throw InputError{path + ": cannot be read; give a table that breakaway study wrote by --csv"};
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::string wrong;
    if (in.eof()) {
      wrong = "is not whole; run that shard again";
    } else if (number == 1) {
      if (line != label) wrong = fmt::format("is not \"{}\": it is of another file, --axis, --laws or --seed", label);
    } else if (number == 2) {
      if (line != columns) wrong = fmt::format("is not {}", columns);
    } else {
      wrong = merge.take(line);
    }
    if (!wrong.empty()) throw InputError{fmt::format("{}:{}: {}", path, number, wrong)};
  }
  if (number < 2) throw InputError{path + ": is no table of a study; give one that breakaway study wrote by --csv"};
}

}  // namespace

std::string study_table_label(const std::string& file_text, const std::string& axis, const StudyOptions& options) {
  Fingerprint print;
  print.mix(file_text);
  print.mix(std::string_view{"\0", 1});
  print.mix(axis);
  return fmt::format("# breakaway study, {} random laws, seed {}, file {:016x}", options.random_laws, options.seed,
                     print.value());
}

std::function<std::string()> study_table_parts(const std::vector<StudyRow>& rows, const std::string& label) {
  return [&rows, label, row = std::size_t{0}, run = std::size_t{0}, begun = false]() mutable {
    std::string part;
    if (!std::exchange(begun, true)) part = fmt::format("{}\n{}\n", label, columns);
    for (std::size_t i = 0; i < runs_of_a_part && row < rows.size();) {
      for (; i < runs_of_a_part && run < rows[row].runs.size(); ++i, ++run)
        part += line_of(rows[row].start, rows[row].runs[run]) + '\n';
      if (run == rows[row].runs.size()) run = 0, ++row;
    }
    return part;
  };
}

std::vector<StudyRow> merged_study(const std::vector<std::string>& paths, const std::string& label,
                                   const StudyOptions& options) {
  Merge merge{options};
  for (const std::string& path : paths) read_table(path, label, merge);
  return merge.whole();
}

}  // namespace breakaway::study
