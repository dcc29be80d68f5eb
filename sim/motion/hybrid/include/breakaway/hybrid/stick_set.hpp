// StickSet: the machine with some friction directions sticking: the motion that is left to it, what is to be watched,
// and when static friction gives way. Everything here depends on which directions stick and on nothing else.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "breakaway/hybrid/flow.hpp"
#include "breakaway/hybrid/types.hpp"

namespace breakaway::hybrid {

using DirectionSet = std::uint32_t;  // bit i: column i of W_T

// Each of the 2^16 sets of sticking directions may have to be factorised.
inline constexpr int most_directions = 16;

constexpr bool contains(DirectionSet set, Eigen::Index i) { return (set >> i & 1U) != 0; }
constexpr DirectionSet only(Eigen::Index i) { return DirectionSet{1} << i; }

// An entry for each direction; not on the heap.
template <int M>
using Signs = Eigen::Matrix<double, M, 1, 0, M == Eigen::Dynamic ? int{most_directions} : M, 1>;

// A sum below this share of its own terms is rounding.
inline constexpr double significance = 1e-12;

// Columns are told apart from dependent ones by this share of their length; entries are rounded to double, so 1e-16 is
// as good as zero.
inline constexpr double rank_threshold = 1e-13;

constexpr int twice(int size) { return size == Eigen::Dynamic ? Eigen::Dynamic : 2 * size; }

// A linear form of the motion, value = integral . Y + now . x with Y the integral of x, and its derivatives.
template <int N>
struct Line {
  using Row = Eigen::Matrix<double, 1, twice(N)>;  // padded with zeros to 2 n
  Row integral, now, first, second, third;
  Row second_bound, third_bound;  // derivative <= bound . amplitudes, for window_s()
  Row settled;                    // first = settled A: the value is constant + settled . x
  Row settled_bound;              // infinite in a block in which there is no such row
  bool drifts = false;            // there is one: the value grows without end
};

// One pair of opposite faces of the set of forces that the sticking directions can bear: |r| <= limit_N with
// r = normal . (K q + C v - F). With independent directions r is one friction force; with dependent ones the set is a
// zonotope, and the faces say when it is left although no single friction force is defined.
template <int N, int M>
struct Facet {
  Eigen::Matrix<double, N, 1> normal, stiffness, damping;  // d, K^T d, C^T d
  double limit_N = 0;
  Eigen::Matrix<double, M, 1> share;  // d . w_i: 0 for directions that the face leaves free
  Line<N> line;
};

// The maps between a state and a stick set's coordinates before they were rounded, n x k and k x n. In a stiff set a
// slow coordinate is what is left of far larger terms: rounded maps, or a rounded state, would move it.
struct FineMaps {
  ExtendedMatrix velocity, from_position, from_velocity, from_force;
};

template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
struct StickSet {
  // These are padded with zeros to 2 n, so that the compiler knows the size.
  using Coordinates = Eigen::Matrix<double, twice(N), 1>;
  using Wide = Eigen::Matrix<double, N, twice(N), N == 1 ? Eigen::RowMajor : Eigen::ColMajor>;
  using Tall = Eigen::Matrix<double, twice(N), N>;

  DirectionSet sticking = 0;  // with all directions that cannot slide while these stick
  Flow flow;
  Wide velocity;  // v = velocity x, q = q0 + velocity Y
  // x = from_position q + from_velocity v + from_force F. The springs' and dampers' forces are in the first two: a
  // stiff spring's force would be rounded to more than what moves slow coordinates.
  Tall from_position, from_velocity, from_force;
  std::shared_ptr<const FineMaps> fine;
  bool stiff = false;                    // its coordinates are found with `fine`
  Eigen::Matrix<double, M, M> coupling;  // accelerations of directions by forces in directions: W^T B B^T W
  std::vector<Line<N>> sliding;          // by direction: g_i; empty for sticking ones
  std::vector<Facet<N, M>> facets;
};

// Returns orthonormal motions (the mass is L L^T, and these are columns of L^T q') in the machine's coordinates. An
// entry below `cancelled` of the largest that there can be is rounding, and is 0: else a force on a coordinate that is
// held would move the free ones a little, and they would never be seen to rest.
template <class Matrix>
Matrix in_coordinates(const Matrix& inverse_factor, const Matrix& motions, double cancelled) {
  Matrix basis = inverse_factor.transpose() * motions;
  for (Eigen::Index i = 0; i < basis.rows(); ++i) {
    const auto largest = inverse_factor.col(i).norm();
    for (Eigen::Index k = 0; k < basis.cols(); ++k) {
      if (abs(basis(i, k)) <= cancelled * largest) basis(i, k) = 0;
    }
  }
  return basis;
}

StickSet<> make_stick_set(const LinearMachine<>& machine, DirectionSet directions);

// Returns the line with its sizes fixed.
template <int N>
Line<N> fixed(const Line<Eigen::Dynamic>& line) {
  return {line.integral,     line.now,         line.first,   line.second,        line.third,
          line.second_bound, line.third_bound, line.settled, line.settled_bound, line.drifts};
}

template <int N, int M>
StickSet<N, M> fixed(const StickSet<>& set) {
  StickSet<N, M> result{set.sticking,
                        set.flow,
                        set.velocity,
                        set.from_position,
                        set.from_velocity,
                        set.from_force,
                        set.fine,
                        set.stiff,
                        set.coupling,
                        {},
                        {}};
  for (const auto& line : set.sliding) result.sliding.push_back(fixed<N>(line));
  for (const auto& facet : set.facets) {
    result.facets.push_back(
        {facet.normal, facet.stiffness, facet.damping, facet.limit_N, facet.share, fixed<N>(facet.line)});
  }
  return result;
}

}  // namespace breakaway::hybrid
