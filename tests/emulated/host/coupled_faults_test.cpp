// The node that is flashed for coupled_gantry.toml at random moments of random runs, while its bus, its drives, its
// encoders or other tools fail: force stays bounded, a fault of one axis stops both in that period, every end has a
// name that stays, and the machine reaches its targets again once the cause is gone.
#include "coupled_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "../../campaign/environment.hpp"
#include "breakaway/canopen/cob_id.hpp"

namespace breakaway::emulated {
namespace {

using namespace std::chrono_literals;
using firmware::AxisFault;

constexpr double max_force_N = 100, no_force_N = 0.1, start_m = 0.03;
// Of the law; a count of a reading, and half a count of a reference.
constexpr double tolerance_m = 1e-5 + 1.5e-6;

class OneRun {
 public:
  OneRun(const CoupledFault& fault, const CoupledFault* second, std::uint64_t seed)
      : fault_{fault}, second_{second}, seed_{seed}, g_{seed} {}

  void go() {
    begin();
    axis_ = g_.random() % axes;
    fault_.cause(g_, axis_);
    const hal::Time cause = g_.now();
    if (second_ != nullptr) {
      for (const hal::Time at = cause + std::chrono::milliseconds{g_.random() % 50}; g_.now() < at;) step();
      second_->cause(g_, 1 - axis_);
    }
    const hal::Time other_target = coin(g_) ? cause + std::chrono::milliseconds{g_.random() % 50} : hal::Time::max();
    follow(cause + 3s, other_target);
    const bool was_faulty = g_.faulty();
    mend(g_);
    if (!was_faulty) follow(g_.now() + 15s, hal::Time::max());
    if (!g_.faulty() && !on_target()) ADD_FAILURE() << "neither on target nor named: " << text();
    g_.run(300ms);
    recover();
    for (std::size_t i = 0; i < axes; ++i)
      EXPECT_LE(g_.drive(i).largest_force_N(g_.now()), max_force_N * (1 + 1e-6)) << text();
  }

 private:
  void begin() {
    g_.wish[0].target_counts = g_.wish[1].target_counts = target(0);
    g_.run(20ms);
    for (auto& wish : g_.wish) wish.enable = true;
    g_.run(std::chrono::milliseconds{static_cast<int>(between(g_, 1, g_.random() % 4 == 0 ? 300 : 1500))});
  }

  std::int32_t target(std::int32_t about) { return about + static_cast<std::int32_t>(between(g_, -1, 1) * 5e3); }

  bool on_target() const {
    if (!g_.holds()) return false;
    for (std::size_t i = 0; i < axes; ++i)
      if (std::abs(g_.error_m(i)) > tolerance_m) return false;
    return true;
  }

  void follow(hal::Time end, hal::Time other_target) {
    hal::Time settled = hal::Time::max();
    while (g_.now() < end) {
      if (g_.now() >= other_target) {
        other_target = hal::Time::max();
        g_.wish[0].target_counts = g_.wish[1].target_counts = target(g_.wish[0].target_counts);
      }
      step();
      if (settled == hal::Time::max() && (g_.faulty() || on_target())) settled = g_.now();
      if (g_.now() > settled + 500ms && (g_.faulty() || on_target())) break;
    }
  }

  void step() {
    g_.step();
    look();
  }

  // What must be so in every period.
  void look() {
    if (!g_.faulty()) return;
    for (std::size_t i = 0; i < axes; ++i) {
      const AxisFault fault = g_.status(i).fault;
      if (named_[i] == AxisFault::none) named_[i] = fault;
      if (fault == AxisFault::none || g_.status(i).running || fault != named_[i])
        fail("a fault of one axis does not stop both by a name that stays");
    }
    if (named_at_ == hal::Time{}) named_at_ = g_.now();
    if (!fault_.of_the_bus && second_ == nullptr && named_[axis_] == AxisFault::stopped_with_another)
      fail("the name is on the axis that has no fault");
    const hal::Duration since = g_.now() - named_at_;
    for (std::size_t i = 0; i < axes; ++i) {
      const bool hears = !fault_.of_the_bus && second_ == nullptr && !(fault_.deaf && i == axis_);
      if (since > (hears ? 2ms : 900ms) && std::abs(g_.force_N(i)) > no_force_N) fail("force after a stop");
    }
  }

  // What an operator does: reset, reference where it is lost, a target that is certified from here, enable.
  void recover() {
    for (int attempt = 0; attempt < 5; ++attempt) {
      for (int n = 0; n < 20000 && !g_.at_rest(); ++n) g_.step();
      for (auto& wish : g_.wish) wish = {.target_counts = wish.target_counts};
      g_.run(150ms);
      const bool lost = lost_reference();
      for (auto& wish : g_.wish) wish.reset_fault = true;
      for (int n = 0; n < 5000 && (g_.faulty() || n < 200); ++n) g_.step();
      if (lost || lost_reference()) refer();
      // Where both ends are nearer than start_m. A beam that an encoder had bent further is for its operator to
      // straighten.
      const double middle_m = (g_.position_m(0) + g_.position_m(1)) / 2;
      const double room_m = 0.97 * start_m - std::abs(g_.position_m(0) - middle_m);
      if ((fault_.encoder || second_ != nullptr) && (room_m < 0 || std::abs(middle_m) > 0.9)) return;
      const auto to = static_cast<std::int32_t>(1e6 * (middle_m + between(g_, -1, 1) * room_m));
      for (auto& wish : g_.wish) wish = {.target_counts = to};
      g_.run(150ms);
      for (auto& wish : g_.wish) wish.enable = true;
      for (int n = 0; n < 20000 && !g_.faulty(); ++n) {
        g_.step();
        if (on_target()) return;
      }
      recoveries_ << "; then " << state();
    }
    ADD_FAILURE() << "not recovered: " << text();
  }
  bool lost_reference() const { return g_.master(0).reference_lost() || g_.master(1).reference_lost(); }
  void refer() {
    for (std::size_t i = 0; i < axes; ++i) g_.wish[i] = {.target_counts = g_.counts(i)};
    g_.run(150ms);
    for (auto& wish : g_.wish) wish.reference = true;
    for (int n = 0; n < 5000 && (n < 200 || lost_reference()); ++n) g_.step();
  }

  void fail(const char* what) {
    if (!failed_) ADD_FAILURE() << what << ": " << text();
    failed_ = true;
  }
  std::string state() const {
    std::ostringstream out;
    for (std::size_t i = 0; i < axes; ++i)
      out << " [" << i << ": " << to_string(g_.status(i).fault) << ", state "
          << static_cast<int>(g_.status(i).feedback.state) << (g_.status(i).running ? ", runs" : "") << ", force "
          << g_.force_N(i) << " N, error " << g_.error_m(i) << "]";
    out << " phase " << static_cast<int>(g_.coordinator().phase()) << " kicks " << g_.coordinator().kicks();
    return out.str();
  }
  std::string text() const {
    std::ostringstream out;
    out << fault_.name << " of axis " << axis_;
    if (second_ != nullptr) out << " and " << second_->name << " of the other";
    out << ", seed " << seed_ << " at " << hal::seconds(g_.now()) << " s, named " << to_string(named_[0]) << " / "
        << to_string(named_[1]) << " at " << hal::seconds(named_at_) << " s;" << state() << recoveries_.str();
    return out.str();
  }

  const CoupledFault& fault_;
  const CoupledFault* second_;  // of the other axis; none
  std::uint64_t seed_;
  FlashedGantry g_;
  std::size_t axis_ = 0;
  std::array<AxisFault, axes> named_{};
  hal::Time named_at_{};
  bool failed_ = false;
  std::ostringstream recoveries_{};
};

// BREAKAWAY_ONSETS runs of each fault from the seeds of BREAKAWAY_FIRST_ONSET on; BREAKAWAY_FAULT names one of them.
TEST(CoupledFaults, AreBoundedStopBothAxesByNameAndAreRecoveredFrom) {
  const long runs = campaign::from_environment("BREAKAWAY_ONSETS", 1);
  const long first = campaign::from_environment("BREAKAWAY_FIRST_ONSET", 0);
  const std::string only = campaign::text_from_environment("BREAKAWAY_FAULT");
  const std::vector<CoupledFault> faults = coupled_faults();
  for (std::size_t f = 0; f < faults.size(); ++f) {
    if (!only.empty() && faults[f].name != only) continue;
    for (long i = first; i < first + runs; ++i) {
      const auto seed = static_cast<std::uint64_t>(i) * 1001 + f;
      // Every third time the other axis has a fault of its own shortly after.
      OneRun{faults[f], seed % 3 == 0 ? &faults[seed / 3 % faults.size()] : nullptr, seed}.go();
    }
  }
}

// A sample may be lost: of either axis, at any time, but two of one axis in a row, which are "feedback stale".
TEST(CoupledFaults, SingleSamplesThatAreLostEndNothingAndTheTargetsAreReached) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    FlashedGantry g{seed};
    std::array<bool, axes + 1> lost_before{};
    const double share = decades(g, 0.01, 1);
    g.port.incoming.lost = 1;
    g.port.incoming.concerns = [&](const hal::CanFrame& f) {
      for (std::uint8_t node = 1; node <= axes; ++node) {
        if (f.id == canopen::tpdo_cob_id(1, node))
          return lost_before[node] = !lost_before[node] && between(g, 0, 1) < share;
      }
      return false;
    };
    for (auto& wish : g.wish) wish.target_counts = static_cast<std::int32_t>(seed) * 1000 - 4000;
    g.run(20ms);
    for (auto& wish : g.wish) wish.enable = true;
    for (int n = 0; n < 8000 && !g.holds() && !g.faulty(); ++n) g.step();
    EXPECT_TRUE(g.holds()) << seed << ", share " << share;
    for (std::size_t i = 0; i < axes; ++i) {
      EXPECT_LE(std::abs(g.error_m(i)), tolerance_m) << seed;
      EXPECT_EQ(g.status(i).fault, AxisFault::none) << to_string(g.status(i).fault) << seed << ", share " << share;
    }
  }
}

}  // namespace
}  // namespace breakaway::emulated
