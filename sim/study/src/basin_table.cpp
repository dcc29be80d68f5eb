#include "breakaway/study/basin_table.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "breakaway/input/input_error.hpp"
#include "breakaway/sil/certificates.hpp"
#include "fingerprint.hpp"
#include "grid_starts.hpp"

namespace breakaway::study {
namespace {

constexpr std::string_view header = "x1,x2,attracted,time_s";

std::string row_text(const Basin& basin, int row) {
  fmt::memory_buffer text;
  const Grid& grid = basin.grid();
  for (int column = 0; column < grid.points; ++column) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", grid.coordinate(column), grid.coordinate(row),
                   static_cast<int>(basin.fate(column, row)), basin.time_s(column, row));
  }
  return fmt::to_string(text);
}

std::optional<std::array<double, 4>> numbers(std::string_view line) {
  std::array<double, 4> values{};
  const char *at = line.data(), *const end = line.data() + line.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, values[i]);
    const bool last = i + 1 == values.size();
    if (error != std::errc{} || (last ? next != end : next == end || *next != ',')) return std::nullopt;
    at = next + 1;
  }
  return values;
}

// The index of a coordinate of the grid, if it is one to the last bit.
std::optional<int> index_of(const Grid& grid, double coordinate) {
  const double place = std::round((coordinate / grid.half_width + 1) / 2 * (grid.points - 1));
  if (!(place >= 0 && place <= grid.points - 1)) return std::nullopt;
  const int index = static_cast<int>(place);
  return grid.coordinate(index) == coordinate ? std::optional{index} : std::nullopt;
}

// Takes the points of tables into a basin, and none that the certificates of its machine exclude.
class PointReader {
 public:
  PointReader(const scenario::MachineScenario& s, Basin& basin) : PointReader{s, sil::certify(s), basin} {}

  // Empty, or what is wrong with the line.
  std::string take(std::string_view line) {
    const auto values = numbers(line);
    if (!values) return fmt::format("is not of the form {}", header);
    const auto [x1, x2, fate, time_s] = *values;
    const auto column = index_of(basin_.grid(), x1), row = index_of(basin_.grid(), x2);
    if (!column || !row) return "is no point of this grid; give the --grid and --window that it was made with";
    if (fate != -1 && fate != 0 && fate != 1) return "has an attracted that is not 1, 0 or -1";
    if (!(time_s >= 0 && std::isfinite(time_s))) return "has a time_s that is no time; run that shard again";
    if (!basin_.shard().owns(*row)) return {};
    return take(*column, *row, static_cast<Fate>(static_cast<int>(fate)), time_s);
  }

 private:
  PointReader(const scenario::MachineScenario& s, const sil::Certificates& certificates, Basin& basin)
      : starts_{basin.grid(), certificates.centre}, proven_{s.machine, certificates}, basin_{basin} {}

  std::string take(int column, int row, Fate told, double time_s) {
    const hybrid::Verdict proved = proven_(starts_.at(column, row));
    if (proved == hybrid::Verdict::captured && told == Fate::lost)
      return "is marked lost, and the machine is certified to come to rest from there; run that shard again";
    if (proved == hybrid::Verdict::lost && told == Fate::attracted)
      return "is marked attracted, and the machine is certified never to come to rest from there; run that shard again";
    if (basin_.fate(column, row) == Fate::pending) basin_.set(column, row, told, time_s);
    const bool same = basin_.fate(column, row) == told &&
                      std::bit_cast<std::uint64_t>(basin_.time_s(column, row)) == std::bit_cast<std::uint64_t>(time_s);
    return same ? "" : "contradicts what is known of this point; the tables are not of one system";
  }

  GridStarts<Eigen::Dynamic> starts_;
  sil::ProvenFate<Eigen::Dynamic> proven_;
  Basin& basin_;
};

void mix(Fingerprint& print, const Eigen::MatrixXd& matrix) {
  print.mix(static_cast<double>(matrix.rows()));
  for (const double entry : matrix.reshaped()) print.mix(entry);
}

// A law by its bounds and by what it gives along a spiral of times, places and speeds.
void mix(Fingerprint& print, const model::FrictionLaw& law) {
  print.mix(law.bounds().lower_N);
  print.mix(law.bounds().upper_N);
  for (int i = 0; i < 32; ++i)
    print.mix(law.level_N(0.01 * i, std::ldexp(i % 2 == 0 ? 1e-4 : -1e-4, i / 2), 1e-5 * i * i));
}

std::uint64_t fingerprint(const scenario::MachineScenario& s) {
  Fingerprint print;
  for (const Eigen::MatrixXd& matrix : {s.machine.mass, s.machine.damping, s.machine.stiffness, s.machine.directions}) {
    mix(print, matrix);
  }
  mix(print, Eigen::MatrixXd{s.machine.friction_N});
  print.mix(s.duration_s);
  if (s.integrator == scenario::Integrator::time_stepping) {
    print.mix(s.step_s);
    print.mix(s.theta);
  }
  // What not every machine has is not counted where it is missing, so that older tables stay readable.
  if (!stability::constant_force(s.machine).isZero(0)) mix(print, Eigen::MatrixXd{s.machine.force_N});
  if (s.integrator == scenario::Integrator::adaptive) print.mix(s.tolerance);
  for (const model::FrictionLaw& law : s.laws) mix(print, law);
  return print.value();
}

[[noreturn]] void refuse_write(const std::string& path) {
  throw InputError{fmt::format("{}: cannot be written: {}; choose another place", path, std::strerror(errno))};
}

std::string table_head(const Grid& grid, const scenario::MachineScenario& s) {
  return fmt::format("{}\n{}\n", table_label(grid, s), header);
}

std::string not_this_label(const std::string& line, const std::string& label) {
  if (line.starts_with('#')) return "is of another system, grid, window or plane: it is not \"" + label + '"';
  return "does not say which system it is of, as \"" + label + "\" does; run that shard again";
}

// Before anything of the file is dropped: one that is not this table may be anything, and its torn line the last of it.
void require_own(const std::string& path, const std::string& label) {
  if (!std::filesystem::is_regular_file(path))
    throw InputError{fmt::format("{}: is no file that rows can be kept in; choose another place", path)};
  std::ifstream in{path, std::ios::binary};
  std::string line;
  std::getline(in, line);
  const bool torn = in.eof();
  if (torn ? !label.starts_with(line) : line != label)
    throw InputError{fmt::format("{}:1: {}", path, not_this_label(line, label))};
}

// What was being written when the run was stopped.
void drop_torn_line(const std::string& path) {
  std::ifstream in{path, std::ios::binary};
  std::uintmax_t whole = 0;
  for (std::string line; std::getline(in, line) && !in.eof();) whole += line.size() + 1;
  in.close();
  std::error_code failed;
  std::filesystem::resize_file(path, whole, failed);
  if (failed) throw InputError{fmt::format("{}: cannot be written: {}", path, failed.message())};
}

}  // namespace

std::function<std::string()> table_parts(const Basin& basin, const scenario::MachineScenario& s) {
  return [&basin, head = table_head(basin.grid(), s), row = -1]() mutable -> std::string {
    if (row < 0) return row = 0, head;
    while (row < basin.grid().points && !basin.shard().owns(row)) ++row;
    return row < basin.grid().points ? row_text(basin, row++) : "";
  };
}

std::string table_label(const Grid& grid, const scenario::MachineScenario& s) {
  return fmt::format("# breakaway basin, {} points, window {}, plane {},{}, system {:016x}", grid.points,
                     grid.half_width, grid.plane[0] + 1, grid.plane[1] + 1, fingerprint(s));
}

void read_table(const std::string& path, const scenario::MachineScenario& s, Basin& basin) {
  std::ifstream in{path, std::ios::binary};
  if (!in || std::filesystem::is_directory(path))
    throw InputError{fmt::format("{}: cannot be read; give a table that breakaway basin wrote", path)};
  const std::string label = table_label(basin.grid(), s);
  PointReader points{s, basin};
  std::size_t number = 0;
  for (std::string line; std::getline(in, line) && !in.eof();) {
    ++number;
    std::string wrong;
    if (number == 1 || line.starts_with('#')) {
      if (line != label) wrong = not_this_label(line, label);
    } else if (line != header) {
      wrong = points.take(line);
    }
    if (!wrong.empty()) throw InputError{fmt::format("{}:{}: {}", path, number, wrong)};
  }
  if (number == 0) throw InputError{fmt::format("{}: has no whole line; run that shard again", path)};
}

Journal::Journal(const std::string& path, const scenario::MachineScenario& s, Basin& basin)
    : path_{path}, file_{nullptr, &std::fclose} {
  if (std::filesystem::exists(path)) {
    require_own(path, table_label(basin.grid(), s));
    drop_torn_line(path);
  }
  const bool continues = std::filesystem::exists(path) && std::filesystem::file_size(path) > 0;
  if (continues) read_table(path, s, basin);
  file_.reset(std::fopen(path.c_str(), "ab"));
  if (!file_) refuse_write(path);
  if (!continues) {
    const std::string head = table_head(basin.grid(), s);
    if (std::fwrite(head.data(), 1, head.size(), file_.get()) != head.size()) refuse_write(path);
  }
}

void Journal::append(const Basin& basin, int row) {
  const std::string text = row_text(basin, row);
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() || std::fflush(file_.get()) != 0) {
    refuse_write(path_);
  }
}

}  // namespace breakaway::study
