// Builds the k3 table that is flashed, with a proof of its accuracy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "breakaway/design/k3.hpp"
#include "breakaway/design/k3_smoothness.hpp"
#include "breakaway/law/k3_table.hpp"

namespace breakaway::design {

template <class Scalar, std::size_t Nodes = 267>
struct BuiltK3Table {
  law::K3Table<Scalar, Nodes> table;
  std::size_t size_bytes;
  double proved_error;  // no position error in (0, range] has a larger relative error of the impulse
};

constexpr int samples_per_interval = 64;

namespace detail {

// Half the distance between floating-point numbers of size `value`.
template <class Scalar>
double half_ulp(double value) {
  return std::ldexp(1.0, std::ilogb(value) - std::numeric_limits<Scalar>::digits);
}

// The largest relative rounding error of a result between `least` and `most`.
template <class Scalar>
double rounding(double least, double most) {
  const double unit = std::numeric_limits<Scalar>::epsilon() / 2;
  return least > 0 ? std::min(unit, half_ulp<Scalar>(most) / least) : unit;
}

// Bounds of h^4/384 R'''' on every interval of length h = spacing [sqrt(m)].
std::vector<Range> hermite_remainders(const K3<double>& law, double spacing, std::size_t intervals);

// The largest |off0 (1 - H) + off1 H - remainder w| over t in [0, 1], with the Hermite weights H = t^2 (3 - 2 t) and
// w = 16 t^2 (1 - t)^2: an upper bound.
double largest_deviation(double off0, double off1, Range remainder);

// The table's relative error on interval `i` is at most the sum of
//   theory    the ideal cubic against the exact law: Hermite's remainder -h^4/24 R''''(.) (t (1 - t))^2; the nodes'
//             deviation from the law (weights: values 0..1, slopes at most 4/27 each); 1e-14 for the computed law
//   place     sqrt and the product with nodes_per_root: the rounded place differs by at most their sum, which moves R
//             by the largest slope of the cubic, D = |rise| + |s0 - rise| + |s1 - rise|
//   cubic     one rounding per operation of K3Table::reduced, each with the weight in t that follows it
//   results   the final sum, the final product, and sqrt once more as a factor of the impulse
// Roundings are taken at their true size in the interval (half an ulp), not at the unit roundoff.
template <class Scalar, std::size_t Nodes>
double proved_error_of_interval(const law::K3Table<Scalar, Nodes>& table, const K3<double>& law, Range remainder,
                                std::size_t i) {
  const double unit = std::numeric_limits<Scalar>::epsilon() / 2;
  const double h = 1.0 / static_cast<double>(table.nodes_per_root);
  const double s_left = static_cast<double>(i) * h, s_right = s_left + h;
  const double r_left = law.reduced(s_left), r_right = law.reduced(s_right);
  const double v0 = table.nodes[i].value, v1 = table.nodes[i + 1].value;
  const double s0 = table.nodes[i].slope, s1 = table.nodes[i + 1].slope;
  const double rise = v1 - v0, cubic = std::fabs(s0 + s1 - 2 * rise), square = std::fabs(3 * rise - 2 * s0 - s1);
  const double steepest = std::fabs(rise) + std::fabs(s0 - rise) + std::fabs(s1 - rise);

  const double off0 = v0 - r_left, off1 = v1 - r_right;
  const double slopes =
      4.0 / 27 * (std::fabs(s0 - h * law.reduced_slope(s_left)) + std::fabs(s1 - h * law.reduced_slope(s_right)));
  const double theory = largest_deviation(off0, off1, remainder) + slopes + 1e-14 * r_right;
  const double root = rounding<Scalar>(s_left, s_right);
  const double place = static_cast<double>(i + 1) * root + half_ulp<Scalar>(static_cast<double>(i) + 0.5);
  const double operations = unit * (4.0 / 27 * (std::fabs(s0 + s1) + 2 * std::fabs(rise) + cubic) + std::fabs(rise) +
                                    std::fabs(rise - s0) + 3 * square + 3 * cubic + 2 * steepest);
  const double results =
      root + rounding<Scalar>(r_left, r_right) + rounding<Scalar>(s_left * r_left, s_right * r_right);
  // The factor 1.001 stands for products of two errors.
  return 1.001 * ((theory + place * steepest + operations) / r_left + results);
}

}  // namespace detail

// The table of k3 over position errors (0, range_m]; range_m is the largest at which the axis may stick,
// c_upper = f_upper / k1. The proof holds where position error and impulse are normal numbers of Scalar.
//
// Refuses a plant that K3 refuses, a range that is not positive, and magnitudes that Scalar cannot hold.
template <class Scalar, std::size_t Nodes = 267>
BuiltK3Table<Scalar, Nodes> build_k3_table(const KickPlant<double>& plant, double range_m) {
  const auto law = K3<double>::make(plant);
  require_positive("the k3 table's range_m", range_m);

  BuiltK3Table<Scalar, Nodes> built{{}, sizeof(law::K3Table<Scalar, Nodes>), 0};
  auto& table = built.table;
  // The range is rounded outwards, then the grid to the float nodes_per_root, whose rounding moves the nodes and not
  // the answers.
  table.root_max = std::nextafter(static_cast<Scalar>(std::sqrt(range_m)), std::numeric_limits<Scalar>::max());
  table.nodes_per_root = std::nextafter(static_cast<Scalar>(Nodes - 1) / table.root_max, Scalar{0});
  const double spacing = 1.0 / static_cast<double>(table.nodes_per_root);
  const auto remainders = detail::hermite_remainders(law, spacing, Nodes - 1);
  for (std::size_t i = 0; i < Nodes; ++i) {
    const double root = static_cast<double>(i) * spacing;
    // With exact values at the nodes the cubic errs to one side only, by the remainder in the middle of the interval.
    // Values lifted by half of that err as little as possible, to both sides.
    const Range& left = remainders[i == 0 ? 0 : i - 1];
    const Range& right = remainders[std::min(i, Nodes - 2)];
    const double lift = (left.least + left.greatest + right.least + right.greatest) / 8;
    table.nodes[i] = {static_cast<Scalar>(law.reduced(root) + lift),
                      static_cast<Scalar>(spacing * law.reduced_slope(root))};
  }
  const Scalar largest = table.nodes.back().value, smallest = table.nodes.front().slope;
  if (!std::isnormal(table.root_max) || !std::isnormal(table.nodes_per_root) || !std::isnormal(smallest) ||
      !std::isnormal(largest) || !std::isnormal(largest * table.root_max)) {
    throw InputError{"the k3 table up to " + to_text(range_m) + " m holds numbers beyond the range of its scalar type" +
                     " (largest impulse " + to_text(law.impulse_Ns(-range_m)) + " N s): use double or check the units"};
  }

  for (std::size_t i = 0; i + 1 < Nodes; ++i) {
    built.proved_error = std::max(built.proved_error, detail::proved_error_of_interval(table, law, remainders[i], i));
  }
  return built;
}

// The largest relative error of the table found at samples_per_interval points between each pair of nodes. It takes
// longer than building the table, and is for reports and tests: what a table promises is its proved error.
template <class Scalar, std::size_t Nodes>
double measured_error(const law::K3Table<Scalar, Nodes>& table, const KickPlant<double>& plant) {
  const auto law = K3<double>::make(plant);
  double worst = 0;
  const std::size_t samples = (Nodes - 1) * samples_per_interval;
  for (std::size_t j = 1; j <= samples; ++j) {
    const double root = static_cast<double>(table.root_max) * static_cast<double>(j) / static_cast<double>(samples);
    const auto y = static_cast<Scalar>(root * root);
    const double error = static_cast<double>(table.impulse_Ns(y)) / law.impulse_Ns(y) - 1;
    worst = std::max(worst, std::fabs(error));
  }
  return worst;
}

}  // namespace breakaway::design
