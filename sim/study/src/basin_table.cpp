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
#include "fingerprint.hpp"

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

// Empty, or what is wrong with the line.
std::string take_line(std::string_view line, Basin& basin) {
  const auto values = numbers(line);
  if (!values) return fmt::format("is not of the form {}", header);
  const auto column = index_of(basin.grid(), (*values)[0]), row = index_of(basin.grid(), (*values)[1]);
  if (!column || !row) return "is no point of this grid; give the --grid and --window that it was made with";
  const double fate = (*values)[2];
  if (fate != -1 && fate != 0 && fate != 1) return "has an attracted that is not 1, 0 or -1";
  if (!basin.shard().owns(*row)) return {};
  const Fate known = basin.fate(*column, *row), told = static_cast<Fate>(static_cast<int>(fate));
  if (known == Fate::pending) basin.set(*column, *row, told, (*values)[3]);
  const bool same = basin.fate(*column, *row) == told && std::bit_cast<std::uint64_t>(basin.time_s(*column, *row)) ==
                                                             std::bit_cast<std::uint64_t>((*values)[3]);
  return same ? "" : "contradicts what is known of this point; the tables are not of one system";
}

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

std::function<std::string()> table_parts(const Basin& basin) {
  return [&basin, row = -1]() mutable -> std::string {
    if (row < 0) return row = 0, std::string{header} + "\n";
    while (row < basin.grid().points && !basin.shard().owns(row)) ++row;
    return row < basin.grid().points ? row_text(basin, row++) : "";
  };
}

std::string table_label(const Grid& grid, const scenario::MachineScenario& s) {
  return fmt::format("# breakaway basin, {} points, window {}, plane {},{}, system {:016x}", grid.points,
                     grid.half_width, grid.plane[0] + 1, grid.plane[1] + 1, fingerprint(s));
}

void read_table(const std::string& path, const std::string& label, Basin& basin) {
  std::ifstream in{path, std::ios::binary};
  if (!in || std::filesystem::is_directory(path))
    throw InputError{fmt::format("{}: cannot be read; give a table that breakaway basin wrote", path)};
  std::size_t number = 0;
  for (std::string line; std::getline(in, line) && !in.eof();) {
    ++number;
    std::string wrong;
    if (line.starts_with('#')) {
      if (line != label) wrong = "is of another system, grid, window or plane: it is not \"" + label + '"';
    } else if (line != header) {
      wrong = take_line(line, basin);
    }
    if (!wrong.empty()) throw InputError{fmt::format("{}:{}: {}", path, number, wrong)};
  }
}

Journal::Journal(const std::string& path, const std::string& label, Basin& basin)
    : path_{path}, file_{nullptr, &std::fclose} {
  const bool continues = std::filesystem::exists(path) && std::filesystem::file_size(path) > 0;
  if (continues) {
    drop_torn_line(path);
    read_table(path, label, basin);
  }
  file_.reset(std::fopen(path.c_str(), "ab"));
  if (!file_) refuse_write(path);
  if (!continues || std::filesystem::file_size(path) == 0) {
    const std::string head = fmt::format("{}\n{}\n", label, header);
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
