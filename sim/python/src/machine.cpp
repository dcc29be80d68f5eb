#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "breakaway/report/attraction_json.hpp"
#include "breakaway/report/basin_json.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/study/attraction.hpp"
#include "breakaway/study/basin.hpp"
#include "core.hpp"

namespace breakaway::python {
namespace {

using study::Basin;
using Plane = std::array<int, 2>;

Plane checked(const Plane& plane, const scenario::MachineScenario& s) {
  const int places = 2 * static_cast<int>(s.machine.coordinates());
  const auto there = [&](int place) { return place >= 0 && place < places; };
  if (there(plane[0]) && there(plane[1]) && plane[0] != plane[1]) return plane;
  throw InputError{"plane", fmt::format("is of two different places of (q, v), each from 0 to {}", places - 1)};
}

double checked_window(double window) {
  if (window > 0 && window <= study::widest_half_width) return window;
  throw InputError{"window", fmt::format("must be above 0 and at most {:g}", study::widest_half_width)};
}

py::tuple attract(const std::string& text, const std::string& name, const Plane& plane, double window, int depth,
                  int threads) {
  std::string json;
  auto found = std::make_shared<std::optional<study::Attraction>>();
  {
    const py::gil_scoped_release unlocked;
    const scenario::MachineScenario s = scenario::parse_machine_scenario(text, name);
    if (depth < 0 || depth > 14) throw InputError{"depth", "must be from 0 to 14"};
    found->emplace(study::find_attraction(s, {.plane = checked(plane, s),
                                              .half_width = window == 0 ? 0 : checked_window(window),
                                              .depth = depth,
                                              .threads = threads_or_all(threads),
                                              .progress = Interruptible{}}));
    json = report::to_json(s, **found);
  }
  using study::Cell;
  py::dict cells;
  static const std::vector<Cell> none;
  const std::vector<Cell>& all = (*found)->region ? (*found)->region->cells() : none;
  cells["level"] = column<int>(found, all, &Cell::level);
  cells["column"] = column<int>(found, all, &Cell::column);
  cells["row"] = column<int>(found, all, &Cell::row);
  static_assert(sizeof(study::Fate) == 1);
  cells["proved"] =
      all.empty() ? py::array_t<std::int8_t>{0}
                  : view(found, reinterpret_cast<const std::int8_t*>(&all.front().proved), all.size(), sizeof(Cell));
  return py::make_tuple(json, cells);
}

py::tuple basin(const std::string& text, const std::string& name, int points, double window, const Plane& plane,
                int threads) {
  std::string json;
  std::shared_ptr<Basin> grid;
  {
    const py::gil_scoped_release unlocked;
    const scenario::MachineScenario s = scenario::parse_machine_scenario(text, name);
    if (points < 2 || points > 10'000) throw InputError{"points", "must be from 2 to 10000"};
    const auto certificates = sil::certify(s);
    grid = std::make_shared<Basin>(study::Grid{points, checked_window(window), checked(plane, s)}, study::Shard{});
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t simulated = study::decide_pending(*grid, s, threads_or_all(threads), Interruptible{});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    json = report::to_json(s, *grid, certificates, {simulated, seconds});
  }
  const auto fates = grid->fates();
  const auto times = grid->times_s();
  const auto square = [points](py::array array) { return array.attr("reshape")(points, points); };
  return py::make_tuple(json, square(view(grid, reinterpret_cast<const std::int8_t*>(fates.data()), fates.size(), 1)),
                        square(view(grid, times.data(), times.size(), sizeof(double))));
}

}  // namespace

void add_machine(py::module_& module) {
  using namespace py::literals;
  module.def("attract", &attract, "text"_a, "name"_a, "plane"_a, "window"_a, "depth"_a, "threads"_a);
  module.def("basin", &basin, "text"_a, "name"_a, "points"_a, "window"_a, "plane"_a, "threads"_a);
}

}  // namespace breakaway::python
