#include "breakaway/law/k3_table.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>

namespace {

using breakaway::law::K3Table;

// The table goes into flash as it is: no constructor may have to run, and it must stay small.
static_assert(std::is_aggregate_v<K3Table<float>>);
static_assert(std::is_trivially_copyable_v<K3Table<float>>);
static_assert(sizeof(K3Table<float>) <= 2150);

// R(s) = 2 + s + s^2 + s^3 over [0, root_max]: cubic Hermite interpolation must return it exactly (to rounding).
template <class Scalar>
constexpr Scalar cubic(Scalar s) {
  return 2 + s * (1 + s * (1 + s));
}

template <class Scalar, std::size_t Nodes = 267>
K3Table<Scalar, Nodes> cubic_table(Scalar root_max) {
  K3Table<Scalar, Nodes> table{};
  table.root_max = root_max;
  table.nodes_per_root = static_cast<Scalar>(Nodes - 1) / root_max;
  const Scalar spacing = root_max / static_cast<Scalar>(Nodes - 1);
  for (std::size_t i = 0; i < Nodes; ++i) {
    const Scalar s = static_cast<Scalar>(i) * spacing;
    table.nodes[i] = {cubic(s), spacing * (1 + s * (2 + 3 * s))};
  }
  return table;
}

TEST(K3Table, InterpolatesACubicExactly) {
  const auto table = cubic_table<double>(2.0);
  for (int i = 0; i <= 10000; ++i) {
    const double s = 2.0 * i / 10000;
    // 8 eps: the roundings of the place, of the nodes and of four operations.
    EXPECT_NEAR(table.reduced(s), cubic(s), 8 * std::numeric_limits<double>::epsilon() * cubic(s)) << "s = " << s;
  }
}

TEST(K3Table, WorksWithASingleInterval) {
  const auto table = cubic_table<double, 2>(1.5);
  for (const double s : {0.0, 0.1, 0.75, 1.4, 1.5}) EXPECT_NEAR(table.reduced(s), cubic(s), 1e-14);
}

TEST(K3Table, ImpulseOpposesTheErrorAndIsOdd) {
  const auto table = cubic_table<float>(2.0F);
  EXPECT_EQ(table.impulse_Ns(0.0F), 0.0F);
  for (int i = 1; i <= 1000; ++i) {
    const float y = 4.0F * static_cast<float>(i) / 1000;
    EXPECT_LT(table.impulse_Ns(y), 0.0F);
    EXPECT_EQ(table.impulse_Ns(-y), -table.impulse_Ns(y));
    EXPECT_NEAR(table.impulse_Ns(-y), std::sqrt(y) * cubic(std::sqrt(y)), 1e-6F * cubic(2.0F) * 2.0F);
  }
}

TEST(K3Table, KeepsItsEndValueBeyondTheLastNode) {
  const auto table = cubic_table<float>(2.0F);
  const float end = table.impulse_Ns(-4.0F);
  EXPECT_NEAR(end, 2.0F * cubic(2.0F), 1e-5F);
  for (const float y : {4.001F, 5.0F, 1e30F, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(table.impulse_Ns(-y), end);
    EXPECT_EQ(table.impulse_Ns(y), -end);
  }
}

TEST(K3Table, TreatsNotANumberAsNoError) {
  const auto table = cubic_table<float>(2.0F);
  EXPECT_EQ(table.impulse_Ns(std::numeric_limits<float>::quiet_NaN()), 0.0F);
  EXPECT_EQ(table.reduced(std::numeric_limits<float>::quiet_NaN()), table.reduced(0.0F));
  EXPECT_EQ(table.reduced(-1.0F), table.reduced(0.0F));
}

// Every 251st bit pattern of a float (251 is prime, so all exponents and signs meet all low bits).
TEST(K3Table, AnswersEveryBitPatternWithinItsRange) {
  const auto table = cubic_table<float>(2.0F);
  const float most = table.impulse_Ns(-4.0F) * (1 + 4 * std::numeric_limits<float>::epsilon());
  for (std::uint64_t bits = 0; bits <= 0xFFFF'FFFFU; bits += 251) {
    const float y = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    const float impulse = table.impulse_Ns(y);
    ASSERT_TRUE(impulse >= -most && impulse <= most) << "bits " << bits;
  }
}

// A damaged flash page must not turn into a read outside the table (the sanitizer build would stop here).
TEST(K3Table, NeverReadsOutsideADamagedTable) {
  std::mt19937 random(20240601);
  for (int trial = 0; trial < 20000; ++trial) {
    auto table = cubic_table<float, 4>(2.0F);
    table.root_max = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    table.nodes_per_root = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    const float y = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    const float reduced = table.reduced(y);
    ASSERT_TRUE(reduced >= cubic(0.0F) * 0.999F && reduced <= cubic(2.0F) * 1.001F) << reduced;
  }
}

TEST(K3Table, IsSilentUntilItIsBuilt) {
  const K3Table<float> table{};
  EXPECT_EQ(table.impulse_Ns(1.0F), 0.0F);
}

}  // namespace
