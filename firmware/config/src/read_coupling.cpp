#include "read_coupling.hpp"

#include <fmt/format.h>

#include <cmath>

#include "breakaway/config/matrix_values.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

using Eigen::Index;

constexpr Range no_less_than_nothing{0, 1e12};

void require_square(const Section& section, std::string_view key, const Eigen::MatrixXd& matrix, Index axes) {
  if (matrix.rows() == axes && matrix.cols() == axes) return;
  section.fail(key, fmt::format("is {} x {}, and the node has {} axes; give a row and a column for each", matrix.rows(),
                                matrix.cols(), axes));
}

void require_told_once(const Section& section, const Coupling& c, const Node& node) {
  for (Index i = 0; i < c.mass.rows(); ++i) {
    const Axis& axis = node.axes[static_cast<std::size_t>(i)];
    if (std::abs(c.mass(i, i) - axis.mass_kg) <= 1e-6 * axis.mass_kg) continue;
    section.fail("mass", fmt::format("has {:.9g} on its diagonal where axis {} has [plant] mass_kg = {:.9g}; make them "
                                     "equal",
                                     c.mass(i, i), axis.name, axis.mass_kg));
  }
}

}  // namespace

Coupling read_coupling(const Section& section, const Node& node) {
  const auto n = static_cast<Index>(node.axes.size());
  Coupling c;
  c.damping = c.stiffness = Eigen::MatrixXd::Zero(n, n);
  c.load_N = Eigen::VectorXd::Zero(n);
  section.read({
      required("mass", matrix(c.mass, "kg")),
      optional("mass_error", number(c.mass_error, "", {0, 0.9})),
      optional("mass_slope_kg_per_m", number(c.mass_slope_kg_per_m, "kg/m", no_less_than_nothing)),
      optional("range_m", number(c.range_m, "m", positive)),
      optional("damping", matrix(c.damping, "N s/m")),
      optional("stiffness", matrix(c.stiffness, "N/m")),
      optional("load_N", vector(c.load_N, "N", no_less_than_nothing)),
      required("start_m", number(c.start_m, "m", positive)),
  });
  require_square(section, "mass", c.mass, n);
  require_square(section, "damping", c.damping, n);
  require_square(section, "stiffness", c.stiffness, n);
  if (c.load_N.size() != n)
    section.fail("load_N",
                 fmt::format("has {} entries, and the node has {} axes; give one for each", c.load_N.size(), n));
  require_told_once(section, c, node);
  if (!node.loop) section.fail("mass", "is of axes that a loop moves together; give the node a [loop]");
  for (const Axis& axis : node.axes) {
    if (!axis.drive || !axis.controller.impulsive)
      section.fail("mass", fmt::format("is of axes with drives under the impulsive law, and axis {} has {}; correct it",
                                       axis.name, axis.drive ? "another controller" : "no [drive]"));
  }
  return c;
}

}  // namespace breakaway::config
