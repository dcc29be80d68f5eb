#include "read_coupled.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <functional>

#include "breakaway/input/input_error.hpp"

namespace breakaway::scenario {

using namespace config;
namespace {

constexpr double largest_share = 1e6;  // levers and gears are far from it

Value place_value(const std::function<PushedOrRead&()>& to) {
  return {.expects = fmt::format(
              "the number of a coordinate, from 1, or an array of a share for each, as [1, 0.5], from {:g} to {:g}",
              -largest_share, largest_share),
          .take =
              [to](const Entry& entry) {
                PushedOrRead& place = to();
                if (integer([&](std::int64_t n) { place.coordinate = n; }, 1, INT64_MAX).take(entry)) return true;
                return numbers(place.row, "", {-largest_share, largest_share}).take(entry);
              },
          .takes_arrays = true};
}

Eigen::VectorXd vector_of(const PushedOrRead& place, Eigen::Index coordinates, const char* key,
                          const std::string& axis) {
  const auto fail = [&](const std::string& what) {
    throw InputError{fmt::format("axis {}: [plant.machine] {} {}", axis, key, what)};
  };
  if (place.coordinate > coordinates)
    fail(fmt::format("is {}, and the [machine] has {} coordinates; give one of them", place.coordinate, coordinates));
  if (place.coordinate > 0) return Eigen::VectorXd::Unit(coordinates, place.coordinate - 1);
  if (place.row.size() != static_cast<std::size_t>(coordinates))
    fail(fmt::format("has {} shares, and the [machine] has {} coordinates; give one for each", place.row.size(),
                     coordinates));
  Eigen::VectorXd row = Eigen::VectorXd::Map(place.row.data(), coordinates);
  if (!(row.cwiseAbs().maxCoeff() >= 1 / largest_share))
    fail(fmt::format("is zero in every coordinate, or below {:g}; give one of them a share", 1 / largest_share));
  return row;
}

}  // namespace

void read_place(const Section& section, PlaceInFile& place) {
  section.read({
      required("push", place_value([&]() -> PushedOrRead& { return place.push; })),
      optional("read", place_value([&]() -> PushedOrRead& { return place.read.emplace(); })),
  });
}

MachinePlace place_in(const CoupledMachine& machine, const PlaceInFile& place, const std::string& axis) {
  const Eigen::Index n = machine.machine.coordinates();
  return {vector_of(place.push, n, "push", axis), vector_of(place.read.value_or(place.push), n, "read", axis)};
}

}  // namespace breakaway::scenario
