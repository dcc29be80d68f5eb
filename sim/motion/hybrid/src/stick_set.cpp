#include "breakaway/hybrid/stick_set.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakaway::hybrid {
namespace {

namespace twofold = stability::twofold;

// Springs are as the squares of rates: double leaves 1e-11 of what differs by more than this.
constexpr double most_ratio_of_rates = 256;

twofold::Span span(ExtendedMatrix columns) {
  for (Eigen::Index i = 0; i < columns.cols(); ++i) columns.col(i).stableNormalize();
  return twofold::span(columns, rank_threshold);
}

// Calls back with every choice of `count` out of the given indices.
template <class Callback>
void for_each_choice(const std::vector<Eigen::Index>& from, std::size_t count, const Callback& callback,
                     std::vector<Eigen::Index> chosen = {}, std::size_t next = 0) {
  if (chosen.size() == count) return callback(chosen);
  for (std::size_t i = next; i < from.size(); ++i) {
    chosen.push_back(from[i]);
    for_each_choice(from, count, callback, chosen, i + 1);
    chosen.pop_back();
  }
}

Eigen::MatrixXd padded(const ExtendedMatrix& matrix, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows, columns);
  result.topLeftCorner(matrix.rows(), matrix.cols()) = matrix.cast<double>();
  return result;
}

Line<Eigen::Dynamic> make_line(const Flow& flow, Eigen::Index coordinates, const ExtendedMatrix& integral,
                               const ExtendedMatrix& now) {
  const ExtendedMatrix& a = flow.generator();
  const ExtendedMatrix first = integral + now * a, second = first * a, third = second * a;
  ExtendedMatrix settled = ExtendedMatrix::Zero(1, flow.size());
  Line<Eigen::Dynamic> line;
  const Eigen::Index width = 2 * coordinates;
  line.second_bound = line.third_bound = line.settled_bound = Eigen::RowVectorXd::Zero(width);
  for (const Block& block : flow.blocks()) {
    const ExtendedMatrix part = a.block(block.first, block.first, block.size, block.size);
    const ExtendedMatrix slope = first.middleCols(block.first, block.size);
    const auto inverse = twofold::inverse_if_regular(part);
    if (inverse) settled.middleCols(block.first, block.size) = slope * *inverse;
    flow.bound(block, second, Flow::Horizon::window, line.second_bound.data());
    flow.bound(block, third, Flow::Horizon::window, line.third_bound.data());
    flow.bound(block, settled, Flow::Horizon::ever, line.settled_bound.data());
    if (!inverse && slope.cwiseAbs().maxCoeff() > Extended(0)) {
      line.drifts = true;
      line.settled_bound.segment(block.first, block.size).setConstant(HUGE_VAL);
    }
  }
  line.integral = padded(integral, 1, width);
  line.now = padded(now, 1, width);
  line.first = padded(first, 1, width);
  line.second = padded(second, 1, width);
  line.third = padded(third, 1, width);
  line.settled = padded(settled, 1, width);
  return line;
}

// The machine in extended precision, and its directions in coordinates in which the mass is the identity.
struct Extension {
  ExtendedMatrix mass, damping, stiffness, inverse_factor, directions;

  explicit Extension(const LinearMachine<>& machine)
      : mass{machine.mass.cast<Extended>()},
        damping{machine.damping.cast<Extended>()},
        stiffness{machine.stiffness.cast<Extended>()},
        inverse_factor{twofold::inverse_cholesky_factor(mass)},
        directions{inverse_factor * machine.directions.cast<Extended>()} {}
};

bool alone_in(const Eigen::MatrixXd& matrix, Eigen::Index i) {
  return (matrix.row(i).array() != 0).count() == (matrix(i, i) != 0 ? 1 : 0);
}

// How many of the last coordinates act on others although nothing acts on them, as what a drive's lag is modelled by.
Eigen::Index count_drivers(const LinearMachine<>& machine) {
  const Eigen::Index n = machine.coordinates();
  Eigen::Index drivers = 0;
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    const bool driven = !machine.directions.row(i).isZero(0) || !alone_in(machine.mass, i) ||
                        !alone_in(machine.damping, i) || !alone_in(machine.stiffness, i);
    const bool acts = !alone_in(machine.damping.transpose(), i) || !alone_in(machine.stiffness.transpose(), i);
    if (driven || !acts) break;
    ++drivers;
  }
  return drivers;
}

// An orthonormal basis of the motions that are left, in the same coordinates; adds to `sticking` what they cannot
// slide.
ExtendedMatrix free_motions(const Extension& extension, Eigen::Index drivers, DirectionSet& sticking) {
  const Eigen::Index n = extension.directions.rows(), m = extension.directions.cols();
  ExtendedMatrix free = ExtendedMatrix::Identity(n, n), chosen = ExtendedMatrix::Zero(n, m);
  for (Eigen::Index i = 0; i < m; ++i) {
    if (contains(sticking, i)) chosen.col(i) = extension.directions.col(i);
  }
  if (sticking != 0) {
    const ExtendedMatrix held = span(chosen.topRows(n - drivers)).complement;
    free.setZero(n, held.cols() + drivers);
    free.topLeftCorner(n - drivers, held.cols()) = held;
    free.bottomRightCorner(drivers, drivers).setIdentity();
  }
  for (Eigen::Index i = 0; i < m; ++i) {
    const Extended left = (free.transpose() * extension.directions.col(i)).norm();
    if (left <= rank_threshold * extension.directions.col(i).norm()) sticking |= only(i);
  }
  return free;
}

// The directions, columns of `reduced`, that lie in the face with this normal.
DirectionSet directions_in(const ExtendedMatrix& reduced, const ExtendedVector& normal) {
  DirectionSet inside = 0;
  for (Eigen::Index i = 0; i < reduced.cols(); ++i) {
    if (abs(reduced.col(i).dot(normal)) <= rank_threshold * reduced.col(i).norm()) inside |= only(i);
  }
  return inside;
}

// The normals, in coordinates of the span of `reduced` (rank x stuck directions), of the zonotope's faces: each is
// orthogonal to rank - 1 independent directions. A face is known by the directions that lie in it: its normal may
// differ from another's by as little as nearly parallel directions do.
std::vector<ExtendedVector> face_normals(const ExtendedMatrix& reduced) {
  const Eigen::Index rank = reduced.rows();
  std::vector<Eigen::Index> all;
  for (Eigen::Index i = 0; i < reduced.cols(); ++i) all.push_back(i);
  std::vector<ExtendedVector> normals;
  std::vector<DirectionSet> known;
  for_each_choice(all, static_cast<std::size_t>(rank - 1), [&](const std::vector<Eigen::Index>& chosen) {
    DirectionSet needed = 0;
    for (const Eigen::Index i : chosen) needed |= only(i);
    const auto has_all = [&](DirectionSet face) { return (needed & ~face) == 0; };
    if (std::any_of(known.begin(), known.end(), has_all)) return;
    ExtendedVector normal = ExtendedVector::Unit(rank, 0);
    if (rank > 1) {
      const twofold::Span face = span(reduced(Eigen::all, chosen));
      if (face.rank() < rank - 1) return;
      normal = face.complement.col(0);
    }
    known.push_back(directions_in(reduced, normal) | needed);
    normals.push_back(normal);
  });
  return normals;
}

Facet<Eigen::Dynamic, Eigen::Dynamic> make_facet(const Extension& extension, const ExtendedVector& normal,
                                                 const Eigen::VectorXd& friction_N, DirectionSet sticking,
                                                 const Flow& flow, const ExtendedMatrix& velocities) {
  const ExtendedVector shares = extension.directions.transpose() * normal;
  Extended largest = 0;
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    if (contains(sticking, i)) largest = std::max(largest, abs(shares[i]));
  }
  Facet<Eigen::Dynamic, Eigen::Dynamic> facet;
  facet.share = Eigen::VectorXd::Zero(shares.size());
  Extended limit = 0;
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    if (!contains(sticking, i)) continue;
    if (abs(shares[i]) <= rank_threshold * extension.directions.col(i).norm()) continue;
    facet.share[i] = static_cast<double>(shares[i] / largest);
    limit += abs(shares[i] / largest) * friction_N[i];
  }
  facet.limit_N = static_cast<double>(limit);
  const ExtendedVector d = extension.inverse_factor.transpose() * normal / largest;
  const ExtendedVector stiffness = extension.stiffness.transpose() * d, damping = extension.damping.transpose() * d;
  facet.normal = d.cast<double>();
  facet.stiffness = stiffness.cast<double>();
  facet.damping = damping.cast<double>();
  facet.line = make_line(flow, d.size(), stiffness.transpose() * velocities, damping.transpose() * velocities);
  return facet;
}

}  // namespace

StickSet<> make_stick_set(const LinearMachine<>& machine, DirectionSet directions) {
  const Extension extension(machine);
  StickSet<> set;
  set.sticking = directions;
  const Eigen::Index drivers = count_drivers(machine);
  const ExtendedMatrix basis =
      in_coordinates(extension.inverse_factor, free_motions(extension, drivers, set.sticking), 1e-28);
  const ExtendedMatrix damping = basis.transpose() * extension.damping * basis,
                       stiffness = basis.transpose() * extension.stiffness * basis;
  auto driven = drivers > 0 ? Flow::driven(damping, stiffness, drivers) : std::nullopt;
  set.flow = driven ? std::move(*driven) : Flow(damping, stiffness);

  const ExtendedMatrix velocities = basis * set.flow.velocity();
  const Eigen::Index n = machine.coordinates();
  set.velocity = padded(velocities, n, 2 * n);
  const ExtendedMatrix from_force = set.flow.from_acceleration() * basis.transpose();
  const ExtendedMatrix from_momentum = set.flow.from_velocity() * basis.transpose();
  const ExtendedMatrix from_position = -from_force * extension.stiffness;
  const ExtendedMatrix from_velocity = from_momentum * extension.mass - from_force * extension.damping;
  set.from_position = padded(from_position, 2 * n, n);
  set.from_velocity = padded(from_velocity, 2 * n, n);
  set.from_force = padded(from_force, 2 * n, n);
  set.fine = std::make_shared<const FineMaps>(FineMaps{velocities, from_position, from_velocity, from_force});
  set.stiff = set.flow.slowest() * most_ratio_of_rates < set.flow.fastest();
  const ExtendedMatrix rates = machine.directions.transpose().cast<Extended>() * basis;
  set.coupling = (rates * rates.transpose()).cast<double>();

  std::vector<Eigen::Index> stuck;
  for (Eigen::Index i = 0; i < machine.frictions(); ++i) {
    const ExtendedMatrix speed = machine.directions.col(i).transpose().cast<Extended>() * velocities;
    set.sliding.push_back(make_line(set.flow, n, ExtendedMatrix::Zero(1, set.flow.size()), speed));
    if (contains(set.sticking, i) && !machine.directions.col(i).isZero(0)) stuck.push_back(i);
  }
  if (stuck.empty()) return set;
  const ExtendedMatrix columns = extension.directions(Eigen::all, stuck);
  const ExtendedMatrix basis_of_stuck = span(columns).basis;
  if (basis_of_stuck.cols() == 0) return set;
  for (const ExtendedVector& normal : face_normals(basis_of_stuck.transpose() * columns)) {
    set.facets.push_back(
        make_facet(extension, basis_of_stuck * normal, machine.friction_N, set.sticking, set.flow, velocities));
  }
  return set;
}

}  // namespace breakaway::hybrid
