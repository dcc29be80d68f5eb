// The coordinates in which z' = A z falls apart, as far as numbers allow.
//
// The real Schur form of A is ordered by time scale and cut into invariant subspaces by Sylvester equations (Bavely &
// Stewart, An algorithm for computing reducing subspaces by block diagonalization, 1979). Eigenvalues whose vectors can
// only be told apart with the loss of digits stay together in one block, so that the change of coordinates is well
// conditioned and only such a cluster is dense.
#pragma once

#include <vector>

#include "breakaway/stability/twofold.hpp"

namespace breakaway::hybrid {

struct InvariantBlocks {
  stability::twofold::Matrix basis;      // A basis = basis generator
  stability::twofold::Matrix generator;  // block diagonal, each block a real Schur form
  std::vector<Eigen::Index> sizes;       // of the blocks, down the diagonal
};

// A: 2k x 2k, for z = (u, u') with u in k coordinates of one kind. The columns of the basis are scaled such that u and
// u' / |lambda| are about one together.
InvariantBlocks invariant_blocks(const stability::twofold::Matrix& a);

// Two coordinates, rotated and scaled so that the motion of the block that begins at `first` can be read from them, as
// in Flow: [mean frequency; -frequency mean], or [mean |mean|; delta^2 / |mean| mean] for two eigenvalues mean +- delta
// too close to be told apart. `other`: as they were, because neither form is well conditioned.
struct PairForm {
  enum class Kind { complex, critical, other };
  Kind kind;
  stability::twofold::Scalar mean, frequency, delta_squared;
};

PairForm make_pair_form(stability::twofold::Matrix& form, stability::twofold::Matrix& basis, Eigen::Index first);

// Exchanges the neighbouring diagonal blocks of sizes p and q, of 1 or 2, that begin at `first` (Bai & Demmel, On
// swapping diagonal blocks in real Schur form, 1993). A form = form block, so that `basis form = A basis` stays true.
// False: they cannot be told apart to rounding, and nothing is changed.
bool exchange(stability::twofold::Matrix& form, stability::twofold::Matrix& basis, Eigen::Index first, Eigen::Index p,
              Eigen::Index q);

// X with A X - X B = C for real Schur forms A and B; its entries are not finite where A and B share an eigenvalue.
stability::twofold::Matrix sylvester(const stability::twofold::Matrix& a, const stability::twofold::Matrix& b,
                                     const stability::twofold::Matrix& c);

}  // namespace breakaway::hybrid
