#include "read_coupled.hpp"

#include <fmt/format.h>

#include <cmath>
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
          .form = {.type = Form::Type::either,
                   .parts = {{.type = Form::Type::integer, .range = {1}},
                             {.type = Form::Type::array,
                              .parts = {{.type = Form::Type::number, .range = {-largest_share, largest_share}}}}}}};
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

constexpr double rounding = 1e-9;  // relative: a bound that is set to the very number holds it

void require_within(const char* key, const Eigen::MatrixXd& truth, const Eigen::MatrixXd& told,
                    const Eigen::MatrixXd& error) {
  const double scale = told.cwiseAbs().maxCoeff() * rounding;
  for (Eigen::Index i = 0; i < truth.rows(); ++i) {
    for (Eigen::Index j = 0; j < truth.cols(); ++j) {
      if (std::abs(truth(i, j) - told(i, j)) <= error(i, j) + scale) continue;
      throw InputError{
          fmt::format("[machine] {} has {:.6g} in row {}, column {}, where [coupling] tells the node {:.6g}, "
                      "give or take {:.4g}; make one hold the other",
                      key, truth(i, j), i + 1, j + 1, told(i, j), error(i, j))};
    }
  }
}

void require_own_place(const Scenario& s, std::size_t i) {
  const auto n = static_cast<Eigen::Index>(s.axes());
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(n, static_cast<Eigen::Index>(i));
  const MachinePlace& place = *s.worlds[i].place;
  if (place.push == unit && place.read == unit) return;
  throw InputError{
      fmt::format("axis {}: [plant.machine] must push and read coordinate {} alone, as [coupling] has its "
                  "axes in the order of the file",
                  s.node.axes[i].name, i + 1)};
}

void require_told_friction(const Scenario& s, std::size_t i) {
  const stability::LinearMachine<>& m = s.machine->machine;
  const auto row = static_cast<Eigen::Index>(i);
  const auto& bounds = s.node.axes[i].friction.bounds;
  const double friction_N = m.friction_N[row];
  if (m.directions(row, row) != 1 || m.directions.row(row).cwiseAbs().sum() != 1)
    throw InputError{"[machine] directions must be one for each axis under a [coupling]: give the unit matrix"};
  if (friction_N < bounds.lower_N * (1 - rounding) || friction_N > bounds.upper_N * (1 + rounding))
    throw InputError{
        fmt::format("[machine] friction_N has {:g} for axis {}, outside its [friction], {:g} to {:g} N; "
                    "make one hold the other",
                    friction_N, s.node.axes[i].name, bounds.lower_N, bounds.upper_N)};
}

// From where the first approach begins.
void require_told_start(const Scenario& s, std::size_t i) {
  const config::Axis& axis = s.node.axes[i];
  const Eigen::VectorXd &q = s.machine->start.q, &v = s.machine->start.v;
  const auto row = static_cast<Eigen::Index>(i);
  const double away_m = std::abs(q[row] - axis.controller.target_m), most_m = s.node.coupling->start_m;
  if (away_m > most_m * (1 + rounding))
    throw InputError{
        fmt::format("[start] q has {:g} for axis {}, {:g} m from its target, and [coupling] start_m is {:g}; "
                    "make one hold the other",
                    q[row], axis.name, away_m, most_m)};
  if (v[row] != 0)
    throw InputError{
        fmt::format("[start] v has {:g} for axis {}, and a [coupling] is of axes that rest when they start; "
                    "leave it out",
                    v[row], axis.name)};
}

}  // namespace

void require_told(const Scenario& s) try {
  if (!s.node.coupling) return;
  if (!s.machine)
    throw InputError{
        "[coupling] tells the node of a machine, and there is no [machine]: describe the one that its axes push"};
  const config::Coupling& told = *s.node.coupling;
  const stability::LinearMachine<>& m = s.machine->machine;
  if (m.coordinates() != told.mass.rows() || m.frictions() != told.mass.rows())
    throw InputError{
        fmt::format("[machine] has {} coordinates and {} frictions, and [coupling] is of {} axes; give one "
                    "of each for every axis",
                    m.coordinates(), m.frictions(), told.mass.rows())};
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(m.coordinates(), m.coordinates());
  require_within("mass", m.mass, told.mass, told.mass_error * told.mass.cwiseAbs());
  require_within("damping", m.damping, told.damping, none);
  require_within("stiffness", m.stiffness, told.stiffness, none);
  require_within("force_N", stability::constant_force(m), Eigen::VectorXd::Zero(m.coordinates()), told.load_N);
  for (std::size_t i = 0; i < s.axes(); ++i)
    require_own_place(s, i), require_told_friction(s, i), require_told_start(s, i);
} catch (const InputError& error) {
  throw error.in_file(s.node.file);
}

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
