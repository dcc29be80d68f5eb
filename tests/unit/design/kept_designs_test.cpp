#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "breakaway/design/braked_kicks.hpp"
#include "example_axes.hpp"

namespace breakaway::design {
namespace {

// What was designed before is kept, and must be that of the very same axis.
TEST(BrakedKicks, AreThoseOfTheirAxisWhateverWasDesignedBefore) {
  const std::vector<void (*)(BrakedClass&)> changes{[](BrakedClass& c) { c.mass_kg.most = 1.1; },
                                                    [](BrakedClass& c) { c.mass_kg.least = 0.9; },
                                                    [](BrakedClass& c) { c.force_gain.most = 1.1; },
                                                    [](BrakedClass& c) { c.force_gain.least = 0.9; },
                                                    [](BrakedClass& c) { c.lag_s.most = 1.2e-4; },
                                                    [](BrakedClass& c) { c.lag_s.least = 0.8e-4; },
                                                    [](BrakedClass& c) { c.friction.lower_N = 2.4; },
                                                    [](BrakedClass& c) { c.friction.upper_N = 4.6; },
                                                    [](BrakedClass& c) { c.load_N = 0.1; },
                                                    [](BrakedClass& c) { c.max_force_N = 40; },
                                                    [](BrakedClass& c) { c.force_step_N = 0.05; },
                                                    [](BrakedClass& c) { c.period_s = 2e-3; },
                                                    [](BrakedClass& c) { c.jitter_s = 1e-4; },
                                                    [](BrakedClass& c) { c.encoder_resolution_m = 2e-6; },
                                                    [](BrakedClass& c) { c.encoder_noise_m = 1e-6; },
                                                    [](BrakedClass& c) { c.latency_periods = 3; },
                                                    [](BrakedClass& c) { c.presliding_stiffness_N_per_m = 1e6; },
                                                    [](BrakedClass& c) { c.fine_tolerance_m = 1e-6; },
                                                    [](BrakedClass& c) {
                                                      c.move = MoveRequest{0.4, 1, 20, {}};
                                                    },
                                                    [](BrakedClass& c) {
                                                      c.move = MoveRequest{0.4, 1, 20, 2000};
                                                    }};
  const auto figures = [](void (*change)(BrakedClass&)) {
    BrakedClass c = testing::braked_example().braked.value();
    c.lag_s = {1e-4, 1e-4};
    if (change != nullptr) change(c);
    const auto design = design_braked_kicks<double>(c);
    const auto& k = design.kicks;
    return std::vector<double>{design.floor_m,
                               design.reach_m,
                               design.least_tolerance_m,
                               k.table.entries[20].a0,
                               k.fine_floor_m,
                               k.spring.reach_m,
                               k.slow_lag,
                               k.fast_lag,
                               static_cast<double>(k.still_periods),
                               static_cast<double>(k.patient_periods),
                               k.approach.hard_m_s2,
                               k.approach.move.acceleration_m_s2,
                               k.approach.move.jerk_m_s3};
  };
  std::vector<std::vector<double>> first{figures(nullptr)};
  for (const auto change : changes) first.push_back(figures(change));
  for (std::size_t i = 0; i < first.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(first[i], first[j]) << i << " is taken for " << j;
  for (std::size_t i = changes.size(); i-- > 0;) EXPECT_EQ(figures(changes[i]), first[i + 1]) << i;
  EXPECT_EQ(figures(nullptr), first[0]);
}

}  // namespace
}  // namespace breakaway::design
