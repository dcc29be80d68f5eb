#include "exact_rank.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Residue = std::uint64_t;
using Residues = Eigen::Matrix<Residue, Eigen::Dynamic, Eigen::Dynamic>;

constexpr int digits = 53;         // of a double
constexpr int bits_of_prime = 30;  // each prime is above 2^30, so that it settles so many bits

Residue power(Residue base, std::uint64_t exponent, Residue prime) {
  Residue result = 1;
  for (; exponent > 0; exponent >>= 1, base = base * base % prime) {
    if ((exponent & 1) != 0) result = result * base % prime;
  }
  return result;
}

// Miller and Rabin's test, which with these bases is a proof below 3.2e9. `odd` is above 7.
bool is_prime(Residue odd) {
  const int twos = std::countr_zero(odd - 1);
  return std::ranges::all_of(std::array<Residue, 4>{2, 3, 5, 7}, [&](Residue base) {
    Residue x = power(base, (odd - 1) >> twos, odd);
    if (x == 1 || x == odd - 1) return true;
    for (int squared = 1; squared < twos; ++squared) {
      x = x * x % odd;
      if (x == odd - 1) return true;
    }
    return false;
  });
}

// The next prime below an odd number.
Residue prime_below(Residue odd) {
  do odd -= 2;
  while (!is_prime(odd));
  return odd;
}

// value / 2^lowest, an integer, modulo a prime.
Residue residue(double value, int lowest, Residue prime) {
  if (value == 0) return 0;
  int exponent = 0;
  const auto mantissa = static_cast<Residue>(std::ldexp(std::abs(std::frexp(value, &exponent)), digits));
  const Residue size =
      mantissa % prime * power(2, static_cast<std::uint64_t>(exponent - digits - lowest), prime) % prime;
  return value > 0 || size == 0 ? size : prime - size;
}

// Gauss' elimination on a square matrix.
Index rank_modulo(Residues a, Residue prime) {
  Index rank = 0;
  for (Index column = 0; column < a.cols(); ++column) {
    Index pivot = rank;
    while (pivot < a.rows() && a(pivot, column) == 0) ++pivot;
    if (pivot == a.rows()) continue;
    a.row(pivot).swap(a.row(rank));
    const Residue inverse = power(a(rank, column), prime - 2, prime);
    for (Index i = rank + 1; i < a.rows(); ++i) {
      const Residue factor = a(i, column) * inverse % prime;
      for (Index j = column; j < a.cols(); ++j) a(i, j) = (a(i, j) + (prime - factor) * a(rank, j)) % prime;
    }
    ++rank;
  }
  return rank;
}

// The exponents of the lowest bit of any entry, and of what no entry reaches.
std::pair<int, int> exponents(const MatrixXd& a) {
  int lowest = 0, highest = 0;
  bool any = false;
  for (const double value : a.reshaped()) {
    if (value == 0) continue;
    int exponent = 0;
    std::frexp(value, &exponent);
    lowest = any ? std::min(lowest, exponent - digits) : exponent - digits;
    highest = any ? std::max(highest, exponent) : exponent;
    any = true;
  }
  return {lowest, highest};
}

}  // namespace

bool rank_of_symmetric_part_at_most(const MatrixXd& a, Index rank) {
  const auto [lowest, highest] = exponents(a);
  // By Hadamard, a minor of k rows with entries below 2^b is below (sqrt(k) 2^b)^k; the sum of two has one bit more.
  const double rows = static_cast<double>(rank + 1);
  const double bits = rows * (highest - lowest + 1 + std::log2(rows) / 2) + 1;
  Residue prime = (Residue{1} << 31) + 1;
  for (double settled = 0; settled < bits; settled += bits_of_prime) {
    prime = prime_below(prime);
    Residues residues(a.rows(), a.cols());
    for (Index i = 0; i < a.rows(); ++i) {
      for (Index j = 0; j < a.cols(); ++j)
        residues(i, j) = (residue(a(i, j), lowest, prime) + residue(a(j, i), lowest, prime)) % prime;
    }
    if (rank_modulo(std::move(residues), prime) > rank) return false;
  }
  return true;
}

}  // namespace breakaway::stability
