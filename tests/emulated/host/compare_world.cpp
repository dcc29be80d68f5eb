// Compares a run of the controller and the world as two images on one emulated bus with the same in this process.
//   compare_world FOLDER   reads controller.report, world.frames and world.positions
// Exit codes: 0 no tick was missed, every frame is equal, and every axis rests on its target; 1 not so; 2 no such run.
#include <fmt/format.h>

#include <fstream>

#include "controller_report.hpp"
#include "world_run.hpp"

namespace breakaway::emulated {
namespace {

// libm differs in its last digits between the processors, and so do positions; no encoder count does.
constexpr double same_position_m = 1e-12;

template <class Item>
std::vector<Item> read_file(const std::string& path) {
  std::ifstream file{path, std::ios::binary | std::ios::ate};
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<Item> items(static_cast<std::size_t>(file.tellg()) / sizeof(Item));
  file.seekg(0).read(reinterpret_cast<char*>(items.data()), static_cast<std::streamsize>(items.size() * sizeof(Item)));
  return items;
}

std::uint64_t hash(const std::vector<LoggedFrame>& frames) {
  std::uint64_t value = 0xCBF29CE484222325U;  // FNV-1a
  for (const LoggedFrame& frame : frames) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&frame);
    for (std::size_t i = 0; i < sizeof frame; ++i) value = (value ^ bytes[i]) * 0x100000001B3U;
  }
  return value;
}

void report_difference(const std::vector<LoggedFrame>& here, const std::vector<LoggedFrame>& there) {
  std::size_t i = 0;
  while (i < here.size() && i < there.size() && here[i] == there[i]) ++i;
  const auto text = [&](const std::vector<LoggedFrame>& frames) {
    if (i == frames.size()) return std::string{"nothing"};
    std::string line = fmt::format("period {}, {:03X}", frames[i].period, frames[i].id);
    for (const std::uint8_t byte : frames[i].data) line += fmt::format(" {:02X}", byte);
    return line;
  };
  fmt::print("first difference, frame {}: host {}; emulated {}\n", i, text(here), text(there));
}

bool compare(const std::string& folder) {
  const auto reports = read_file<ControllerReport>(folder + "/controller.report");
  if (reports.size() != 1) throw std::runtime_error("controller.report is not one report");
  const ControllerReport& c = reports[0];
  fmt::print("emulated  start result {}, {} ticks, {} missed, {} late, {} frames lost\n", c.start_result, c.ticks,
             c.missed, c.late, c.lost_frames);
  const bool on_time = c.ticks == ticks_to_run && c.missed == 0 && c.late == 0 && c.lost_frames == 0;

  const WorldRun run{ticks_to_run};
  const NodeWorld& here = run.world();
  const auto frames = read_file<LoggedFrame>(folder + "/world.frames");
  const auto positions_m = read_file<double>(folder + "/world.positions");
  const bool equal = frames == here.frames();
  if (!equal) report_difference(here.frames(), frames);
  if (positions_m.size() != here.positions_m().size()) throw std::runtime_error("world.positions has another length");
  double difference_m = 0;
  for (std::size_t i = 0; i < positions_m.size(); ++i)
    difference_m = std::max(difference_m, std::abs(positions_m[i] - here.positions_m()[i]));
  fmt::print("host      {} frames, hash {:016x}\nemulated  {} frames, hash {:016x}\n", here.frames().size(),
             hash(here.frames()), frames.size(), hash(frames));
  for (std::size_t axis = 0; axis < world_axes.size(); ++axis)
    fmt::print("axis {}    final error {:.9g} m, {}\n", axis, here.error_m(axis),
               here.resting(axis) ? "at rest" : "moving");
  const bool passed = on_time && equal && here.settled() && difference_m <= same_position_m;
  fmt::print("{}: every frame is {}; positions differ by {:.2g} m at most\n", passed ? "PASS" : "FAIL",
             equal ? "equal" : "NOT equal", difference_m);
  return passed;
}

}  // namespace
}  // namespace breakaway::emulated

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: compare_world FOLDER\n");
    return 2;
  }
  try {
    return breakaway::emulated::compare(argv[1]) ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "compare_world: {}\n", error.what());
    return 2;
  }
}
