#include "random_machine.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace breakaway::campaign {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A A^T, summed in one order everywhere, so that it is symmetric and the same to the last bit.
MatrixXd square(const MatrixXd& a) {
  MatrixXd result = MatrixXd::Zero(a.rows(), a.rows());
  for (Index i = 0; i < a.rows(); ++i) {
    for (Index j = 0; j < a.rows(); ++j) {
      for (Index k = 0; k < a.cols(); ++k) result(i, j) += a(i, k) * a(j, k);
    }
  }
  return result;
}

class Draw {
 public:
  explicit Draw(std::int64_t number) : bits_{static_cast<std::uint64_t>(number) * 0x9E3779B97F4A7C15U + 1} {}

  double unit() { return std::ldexp(static_cast<double>(bits_() >> 11U), -53); }  // in [0, 1)
  double both() { return 2 * unit() - 1; }                                        // in [-1, 1)
  Index whole(Index low, Index high) {
    return low + static_cast<Index>(bits_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool one_in(Index n) { return whole(1, n) == 1; }
  // Between 2^low and 2^high, each power of two as likely as the others.
  double power(Index low, Index high) { return std::ldexp(1 + unit(), static_cast<int>(whole(low, high - 1))); }
  MatrixXd matrix(Index rows, Index columns) {
    MatrixXd result(rows, columns);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < columns; ++j) result(i, j) = both();
    }
    return result;
  }
  MatrixXd scaled_matrix(Index rows, Index columns, Index low, Index high) {
    const MatrixXd entries = matrix(rows, columns);
    return entries * power(low, high);
  }
  // Whole numbers from -most to most.
  MatrixXd whole_matrix(Index rows, Index columns, Index most) {
    MatrixXd result(rows, columns);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < columns; ++j) result(i, j) = static_cast<double>(whole(-most, most));
    }
    return result;
  }
  MatrixXd definite(Index n, double least) { return square(matrix(n, n)) + least * MatrixXd::Identity(n, n); }

 private:
  std::mt19937_64 bits_;
};

MatrixXd symmetric_scaled(const MatrixXd& matrix, const VectorXd& scale) {
  const MatrixXd result = scale.asDiagonal() * matrix * scale.asDiagonal();
  return result.selfadjointView<Eigen::Lower>();
}

// No column is nothing.
void mend_columns(MatrixXd& directions) {
  for (Index j = 0; j < directions.cols(); ++j) {
    if (directions.col(j).isZero(0)) directions(j % directions.rows(), j) = 1;
  }
}

Index small_size(Draw& draw) { return std::min(draw.whole(1, 6), draw.whole(1, 6)); }

// Braces around the two numbers draw them in order.
struct Size {
  Index coordinates, directions;
};

RandomMachine ordinary(Draw& draw, Size size) {
  const Index n = size.coordinates, m = size.directions;
  RandomMachine r;
  r.machine.mass = draw.definite(n, 0.3);
  r.machine.damping = draw.definite(n, 0.0);
  r.machine.damping *= draw.power(-6, 0);
  r.machine.stiffness = draw.definite(n, 0.1);
  r.machine.stiffness *= draw.power(-1, 4);
  r.machine.directions = draw.matrix(n, m);
  r.machine.friction_N = VectorXd(m);
  for (double& p : r.machine.friction_N) p = draw.power(-5, 0);
  r.start.q = draw.matrix(n, 1) * 3;
  r.start.v = draw.matrix(n, 1);
  if (draw.one_in(4)) r.start.v.setZero();
  r.end_s = draw.power(2, 5);
  return r;
}

void make_redundant(Draw& draw, RandomMachine& r) {
  MatrixXd& w = r.machine.directions;
  const Index n = w.rows(), m = w.cols();
  const Index base = draw.whole(1, std::min(n, m));
  w = draw.whole_matrix(n, m, 4);
  mend_columns(w);
  for (Index j = base; j < m; ++j) {
    w.col(j) = w.leftCols(base) * draw.whole_matrix(base, 1, 2);
  }
  mend_columns(w);
}

RandomMachine redundant(Draw& draw) {
  RandomMachine r = ordinary(draw, {small_size(draw), draw.whole(2, 7)});
  make_redundant(draw, r);
  return r;
}

RandomMachine switched_off(Draw& draw) {
  RandomMachine r = ordinary(draw, {small_size(draw), draw.whole(2, 6)});
  if (draw.one_in(2)) make_redundant(draw, r);
  for (double& p : r.machine.friction_N) {
    if (draw.one_in(3)) p = 0;
  }
  return r;
}

RandomMachine nearly_parallel(Draw& draw) {
  RandomMachine r = ordinary(draw, {std::max<Index>(2, small_size(draw)), draw.whole(2, 4)});
  MatrixXd& w = r.machine.directions;
  w.col(1) = w.col(0) + draw.scaled_matrix(w.rows(), 1, -40, -10);
  return r;
}

RandomMachine friction_ratio(Draw& draw) {
  RandomMachine r = ordinary(draw, {small_size(draw), draw.whole(2, 5)});
  for (double& p : r.machine.friction_N) p = draw.power(-40, 1);
  r.machine.friction_N[0] = draw.power(-2, 2);
  return r;
}

RandomMachine stiff_damping(Draw& draw) {
  RandomMachine r = ordinary(draw, {std::max<Index>(2, small_size(draw)), draw.whole(1, 4)});
  const MatrixXd along = draw.matrix(r.start.q.size(), 1);
  const MatrixXd added = square(along) * draw.power(4, 40);
  r.machine.damping += added;
  return r;
}

RandomMachine stiff_springs(Draw& draw) {
  RandomMachine r = ordinary(draw, {std::max<Index>(2, small_size(draw)), draw.whole(1, 4)});
  const Index n = r.start.q.size(), i = draw.whole(0, n - 2);
  const double stiffness = draw.power(4, 40);
  r.machine.stiffness(i, i) += stiffness;
  r.machine.stiffness(i + 1, i + 1) += stiffness;
  r.machine.stiffness(i, i + 1) -= stiffness;
  r.machine.stiffness(i + 1, i) -= stiffness;
  r.start.q[i + 1] = r.start.q[i];  // the spring is not loaded, else all its energy is in one oscillation
  r.end_s /= 16;
  return r;
}

// x'' + 2 a x' + a^2 x with a chain of ones above the diagonal, in one of the matrices or both.
RandomMachine defective(Draw& draw) {
  const Index n = draw.whole(1, 4);
  RandomMachine r = ordinary(draw, {n, draw.whole(1, 4)});
  const auto rate = static_cast<double>(draw.whole(1, 3));
  r.machine.mass.setIdentity();
  r.machine.damping = 2 * rate * MatrixXd::Identity(n, n);
  r.machine.stiffness = rate * rate * MatrixXd::Identity(n, n);
  for (Index i = 0; i + 1 < n; ++i) {
    if (draw.one_in(2)) r.machine.damping(i, i + 1) = 1;
    if (draw.one_in(2)) r.machine.stiffness(i, i + 1) = 1;
  }
  return r;
}

RandomMachine non_normal(Draw& draw) {
  const Index n = draw.whole(2, 5);
  RandomMachine r = ordinary(draw, {n, draw.whole(1, 4)});
  const double size = draw.power(3, 20);
  for (Index i = 0; i + 1 < n; ++i) {
    if (draw.one_in(2)) r.machine.damping(i, i + 1) += size * draw.both();
    if (draw.one_in(2)) r.machine.stiffness(i, i + 1) += size * draw.both();
  }
  return r;
}

RandomMachine light_mass(Draw& draw) {
  RandomMachine r = ordinary(draw, {std::max<Index>(2, small_size(draw)), draw.whole(1, 4)});
  VectorXd scale = VectorXd::Ones(r.start.q.size());
  scale[draw.whole(0, scale.size() - 1)] = draw.power(-20, -3);
  r.machine.mass = symmetric_scaled(r.machine.mass, scale);
  if (draw.one_in(2)) r.machine.damping += 0.5 * MatrixXd::Identity(scale.size(), scale.size());
  return r;
}

RandomMachine negative_damping(Draw& draw) {
  RandomMachine r = ordinary(draw, {small_size(draw), draw.whole(1, 5)});
  const MatrixXd along = draw.matrix(r.start.q.size(), 1);
  const MatrixXd taken = square(along) * draw.power(-4, 1);
  r.machine.damping -= taken;
  return r;
}

RandomMachine ties(Draw& draw) {
  const Index n = draw.whole(1, 4), m = draw.whole(1, 6);
  RandomMachine r = ordinary(draw, {n, m});
  r.machine.mass.setIdentity();
  const MatrixXd root = draw.whole_matrix(n, n, 1);
  r.machine.stiffness = square(root) + MatrixXd::Identity(n, n);
  r.machine.damping = draw.one_in(2) ? MatrixXd(MatrixXd::Zero(n, n)) : MatrixXd(MatrixXd::Identity(n, n) / 4);
  r.machine.directions = draw.whole_matrix(n, m, 1);
  mend_columns(r.machine.directions);
  for (double& p : r.machine.friction_N) p = static_cast<double>(draw.whole(1, 4)) / 4;
  r.start.q = draw.whole_matrix(n, 1, 4);
  r.start.v = draw.whole_matrix(n, 1, 1);
  return r;
}

RandomMachine on_boundary(Draw& draw) {
  RandomMachine r = ties(draw);
  const Index n = r.start.q.size(), m = std::min(n, r.machine.directions.cols());
  r.machine.directions = MatrixXd::Identity(n, m);
  r.machine.friction_N.resize(m);
  const VectorXd pull = r.machine.stiffness * r.start.q;
  r.start.v.setZero();
  for (Index i = 0; i < m; ++i) {
    r.machine.friction_N[i] = draw.one_in(3) ? std::abs(pull[i]) + 0.5 : std::max(std::abs(pull[i]), 0.25);
  }
  return r;
}

RandomMachine overdamped(Draw& draw) {
  RandomMachine r = ordinary(draw, {small_size(draw), draw.whole(1, 4)});
  const Index n = r.start.q.size();
  r.machine.damping += draw.power(2, 6) * MatrixXd::Identity(n, n);
  if (draw.one_in(2)) r.machine.friction_N *= 1.0 / 64;
  return r;
}

RandomMachine mirrored(Draw& draw) {
  const Index n = draw.whole(1, 3), m = draw.whole(1, 3);
  const RandomMachine half = ordinary(draw, {n, m});
  RandomMachine r = half;
  const auto doubled = [&](const MatrixXd& part, double coupling) {
    MatrixXd whole = MatrixXd::Zero(2 * n, 2 * n);
    whole.topLeftCorner(n, n) = whole.bottomRightCorner(n, n) = part;
    whole.diagonal(n).setConstant(coupling);
    whole.diagonal(-n).setConstant(coupling);
    return whole;
  };
  r.machine.mass = doubled(half.machine.mass, 0);
  r.machine.damping = doubled(half.machine.damping, 0);
  r.machine.stiffness = doubled(half.machine.stiffness, draw.one_in(2) ? -0.0625 : 0.03125);
  r.machine.directions = MatrixXd::Zero(2 * n, 2 * m);
  r.machine.directions.topLeftCorner(n, m) = r.machine.directions.bottomRightCorner(n, m) = half.machine.directions;
  r.machine.friction_N = half.machine.friction_N.replicate(2, 1);
  const double side = draw.one_in(2) ? 1 : -1;
  r.start.q = half.start.q.replicate(2, 1);
  r.start.v = half.start.v.replicate(2, 1);
  r.start.q.tail(n) *= side;
  r.start.v.tail(n) *= side;
  return r;
}

RandomMachine constant_force(Draw& draw) {
  RandomMachine r = ordinary(draw, {small_size(draw), draw.whole(1, 4)});
  r.machine.force_N = draw.scaled_matrix(r.start.q.size(), 1, -2, 2);
  if (draw.one_in(3)) r.machine.stiffness.setZero();
  if (draw.one_in(6)) r.machine.damping.setZero();
  return r;
}

RandomMachine gyroscopic(Draw& draw) {
  RandomMachine r = ordinary(draw, {std::max<Index>(2, small_size(draw)), draw.whole(1, 4)});
  const MatrixXd skew = draw.scaled_matrix(r.start.q.size(), r.start.q.size(), -1, 4);
  r.machine.damping += skew - skew.transpose();
  return r;
}

RandomMachine circulatory(Draw& draw) {
  RandomMachine r = ordinary(draw, {std::max<Index>(2, small_size(draw)), draw.whole(1, 4)});
  const MatrixXd skew = draw.scaled_matrix(r.start.q.size(), r.start.q.size(), -4, 1);
  r.machine.stiffness += skew - skew.transpose();
  r.end_s = std::min(r.end_s, 16.0);
  return r;
}

RandomMachine many(Draw& draw) {
  RandomMachine r = ordinary(draw, {draw.whole(7, 12), draw.whole(7, 16)});
  if (draw.one_in(4)) make_redundant(draw, r);
  r.end_s /= 4;
  return r;
}

RandomMachine of_family(Family family, Draw& draw) {
  switch (family) {
    case Family::ordinary: {
      const Index n = small_size(draw);
      return ordinary(draw, {n, draw.whole(1, 6)});
    }
    case Family::redundant:
      return redundant(draw);
    case Family::switched_off:
      return switched_off(draw);
    case Family::nearly_parallel:
      return nearly_parallel(draw);
    case Family::friction_ratio:
      return friction_ratio(draw);
    case Family::stiff_damping:
      return stiff_damping(draw);
    case Family::stiff_springs:
      return stiff_springs(draw);
    case Family::defective:
      return defective(draw);
    case Family::non_normal:
      return non_normal(draw);
    case Family::light_mass:
      return light_mass(draw);
    case Family::negative_damping:
      return negative_damping(draw);
    case Family::ties:
      return ties(draw);
    case Family::on_boundary:
      return on_boundary(draw);
    case Family::overdamped:
      return overdamped(draw);
    case Family::mirrored:
      return mirrored(draw);
    case Family::constant_force:
      return constant_force(draw);
    case Family::gyroscopic:
      return gyroscopic(draw);
    case Family::circulatory:
      return circulatory(draw);
    case Family::many:
      break;
  }
  return many(draw);
}

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::ostringstream text;
  text.precision(17);
  for (Index i = 0; i < numbers.size(); ++i) text << (i == 0 ? "[" : ", ") << numbers[i];
  return text.str() + "]";
}

std::string rows(const MatrixXd& matrix) {
  std::string text;
  for (Index i = 0; i < matrix.rows(); ++i) text += (i == 0 ? "[" : ", ") + list(VectorXd(matrix.row(i)));
  return text + "]";
}

}  // namespace

std::string_view to_string(Family family) {
  constexpr std::array<std::string_view, families> names{
      "ordinary",      "redundant",  "switched_off", "nearly_parallel", "friction_ratio",   "stiff_damping",
      "stiff_springs", "defective",  "non_normal",   "light_mass",      "negative_damping", "ties",
      "on_boundary",   "overdamped", "mirrored",     "constant_force",  "gyroscopic",       "circulatory",
      "many"};
  return names.at(static_cast<std::size_t>(family));
}

RandomMachine random_machine(std::int64_t number) {
  Draw draw{number};
  const auto family = static_cast<Family>(number % families);
  RandomMachine result = of_family(family, draw);
  result.number = number;
  result.family = family;
  result.start.time_s = 0;
  return result;
}

std::string to_scene(const RandomMachine& random) {
  const stability::LinearMachine<>& m = random.machine;
  std::ostringstream text;
  text.precision(17);
  text << "title = \"machine " << random.number << " of the campaign, " << to_string(random.family) << "\"\n[machine]\n"
       << "mass = " << rows(m.mass) << "\ndamping = " << rows(m.damping) << "\nstiffness = " << rows(m.stiffness)
       << "\ndirections = " << rows(m.directions) << "\nfriction_N = " << list(m.friction_N);
  if (m.force_N.size() > 0) text << "\nforce_N = " << list(m.force_N);
  text << "\n[start]\nq = " << list(random.start.q) << "\nv = " << list(random.start.v)
       << "\n[run]\nduration_s = " << random.end_s << "\n";
  return text.str();
}

}  // namespace breakaway::campaign
