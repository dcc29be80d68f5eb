// Every named fault at random moments of random runs of the node that is shipped: force stays bounded, it is off in
// time, every end has a name, and the axis reaches its target again once the cause is gone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "breakaway/cia402/forced_stop.hpp"
#include "campaign_node.hpp"
#include "environment.hpp"
#include "named_faults.hpp"

namespace breakaway::campaign {
namespace {

using firmware::AxisFault;

enum class End : std::uint8_t { went_on, waits, named, unnamed };

struct Outcome {
  End end = End::unnamed;
  AxisFault fault = AxisFault::none;
  hal::Duration onset{}, until_named{}, until_no_force{};
  double largest_force_N = 0;
  bool stopped_in_time = true, recovered = false;
  std::string last_state{};
};

constexpr double no_force_N = 0.1;
constexpr hal::Duration longest_wait = 80s;

// From the name of a fault until the drive has no force.
hal::Duration allowed(Stop stop) {
  if (stop == Stop::at_once) return 2 * FaultWorld::period;
  return cia402::Drive<float>::stop_time + cia402::StateMachine::quick_stop_time + cia402::ForcedStop::round_time;
}

std::string state_of(FaultWorld& w) {
  std::ostringstream text;
  text << "fault " << to_string(w.fault()) << ", state " << static_cast<int>(w.status().feedback.state) << ", mode "
       << static_cast<int>(w.status().output.mode) << ", drive " << to_string(w.drive().state()) << ", set-up "
       << to_string(w.master().setup_status()) << ", at " << w.axis.true_position_m() << " of " << w.target_m()
       << " m, force " << w.force_N() << " N";
  return text.str();
}

class OneRun {
 public:
  OneRun(const CampaignNode& node, const NamedFault& fault, std::uint64_t seed)
      : fault_{fault},
        start_m_{start_of(seed)},
        w_{node, start_m_, seed},
        absolute_{node.axes[0].drive.absolute_encoder},
        referenced_{absolute_},
        wished_{std::uniform_real_distribution<>{0, 1}(w_.random) < 0.85} {}

  Outcome result() {
    begin();
    fault_.cause(w_);
    follow();
    fault_.mend(w_);
    w_.run(300ms);
    recover();
    run_.largest_force_N = w_.drive().largest_force_N(w_.now());
    if (!run_.recovered) run_.last_state += "; after resets " + state_of(w_);
    return run_;
  }

 private:
  static double start_of(std::uint64_t seed) {
    std::mt19937_64 random{seed};
    return std::uniform_real_distribution<>{-0.6, 0.6}(random);
  }
  double between(double low, double high) { return std::uniform_real_distribution<>{low, high}(w_.random); }

  void begin() {
    const auto onset =
        std::chrono::microseconds{static_cast<std::int64_t>(between(0, 1) < 0.3 ? between(0, 3e5) : between(0, 2e6))};
    w_.run(10ms);
    if (referenced_)
      w_.wish.enable = wished_;
    else
      w_.wish = {.reference = true, .target_counts = counts(start_m_)};
    w_.run(5ms);  // it was said
    while (w_.now().time_since_epoch() < onset) advance();
    if (referenced_ && between(0, 1) < 0.3) w_.wish.target_counts = static_cast<std::int32_t>(between(-3e5, 3e5));
    w_.run(2ms);  // what was wished last is said
    run_.onset = w_.now().time_since_epoch();
    referenced_before_ = referenced_;
  }

  static std::int32_t counts(double position_m) { return static_cast<std::int32_t>(std::lround(position_m * 1e6)); }

  // An axis whose encoder is incremental is told where it stands, before it is enabled.
  void advance() {
    w_.step();
    if (referenced_ || !w_.wish.reference || std::abs(w_.master().position_counts() - counts(start_m_)) > 1) return;
    referenced_ = true;
    w_.wish = {.enable = wished_};
  }

  // Until it is clear how this ends.
  void follow() {
    const hal::Time cause = w_.now();
    hal::Time named{}, ending_since{};
    bool ending = false;
    double half_way_m = 0;
    for (; w_.now() - cause < longest_wait; advance()) {
      const bool without_force = std::abs(w_.force_N()) <= no_force_N;
      if (run_.end != End::named && w_.fault() != AxisFault::none) {
        run_.end = End::named;
        run_.fault = w_.fault();
        named = w_.now();
        run_.until_named = named - cause;
      }
      if (run_.end == End::named && !without_force) run_.until_no_force = w_.now() - named + FaultWorld::period;
      if (run_.end != End::named) run_.end = waits(w_.now() - cause) ? End::waits : End::went_on;
      const bool truth_known = referenced_before_ && !fault_.encoder;
      const bool on_target = truth_known ? w_.on_target() : w_.holds_shown_target();
      const bool at_end = run_.end == End::went_on ? on_target : without_force;
      if (at_end && !ending) ending_since = w_.now();
      ending = at_end;
      if (w_.now() - cause < longest_wait / 2) half_way_m = distance_m();
      if (ending && w_.now() - ending_since > (run_.end == End::named ? 300ms : 1000ms)) break;
    }
    // A force that is hardly larger than friction takes its time.
    const bool comes_nearer = run_.end == End::went_on && w_.status().running && distance_m() < half_way_m - 1e-4;
    if (!ending && !comes_nearer) run_.end = End::unnamed;
    if (run_.end == End::unnamed) run_.last_state = state_of(w_);
    run_.stopped_in_time = run_.until_no_force <= allowed(fault_.stop);
  }

  double distance_m() const { return std::abs(w_.axis.true_position_m() - w_.target_m()); }

  // Nobody wishes the axis enabled, or it says that it waits for that to be said anew, or the wish never came through.
  bool waits(hal::Duration since) const {
    if (!w_.wish.enable) return true;
    if (w_.status().running) return false;
    return (fault_.needs_edge && w_.status().feedback.state == hal::DriveState::disabled) ||
           (!referenced_before_ && since > 25s);
  }

  // What an operator does: reset, enable, and the same again where another fault comes of it.
  void recover() {
    // A reference that was taken from a broken encoder or while the axis was pushed, or that a controller forgot, is
    // none.
    if (!absolute_ && (fault_.encoder || fault_.needs_edge || !referenced_before_)) referenced_ = false;
    for (int attempt = 0; attempt < 5 && !run_.recovered; ++attempt) {
      if (w_.fault() == AxisFault::reference_lost) referenced_ = false;
      // Nobody enables an axis that still runs out.
      for (int i = 0; i < 30000 && !w_.axis.at_rest(); ++i) w_.step();
      w_.wish = {.reset_fault = true};
      for (int i = 0; i < 3000 && (w_.fault() != AxisFault::none || i < 200); ++i) w_.step();
      w_.wish = {};
      if (!referenced_) refer();
      w_.run(150ms);
      w_.wish.enable = true;
      for (int i = 0; i < 20000 && w_.fault() == AxisFault::none && !run_.recovered; ++i) {
        w_.step();
        run_.recovered = w_.on_target();
      }
    }
  }

  // The operator sees where the axis stands, once it does.
  void refer() {
    for (int i = 0; i < 5000 && !w_.axis.at_rest(); ++i) w_.step();
    const std::int32_t here = counts(w_.axis.true_position_m());
    w_.wish = {.target_counts = here};
    w_.run(150ms);
    w_.wish.reference = true;
    // A controller whose clock was set back by 10 s sets the drive up only when that time is over.
    for (int i = 0; i < 20000 && (i < 150 || !stands_at(here)); ++i) w_.step();
    w_.wish = {};
    referenced_ = stands_at(here);
  }

  bool stands_at(std::int32_t here) const {
    return !w_.master().reference_lost() && std::abs(w_.master().position_counts() - here) <= 1;
  }

  const NamedFault& fault_;
  double start_m_;
  FaultWorld w_;
  Outcome run_;
  bool absolute_;
  bool referenced_, referenced_before_ = false;
  bool wished_;
};

struct Row {
  long runs = 0, went_on = 0, waits = 0, unnamed = 0, over_limit = 0, late = 0, lost = 0;
  std::map<std::string_view, long> names;
  double named_ms = 0, no_force_ms = 0;

  void add(const Outcome& run) {
    ++runs;
    went_on += run.end == End::went_on;
    waits += run.end == End::waits;
    unnamed += run.end == End::unnamed;
    over_limit += run.largest_force_N > FaultWorld::max_force_N * (1 + 1e-6);
    late += !run.stopped_in_time;
    lost += !run.recovered;
    if (run.end != End::named) return;
    ++names[to_string(run.fault)];
    named_ms = std::max(named_ms, 1e3 * hal::seconds(run.until_named));
    no_force_ms = std::max(no_force_ms, 1e3 * hal::seconds(run.until_no_force));
  }
  std::string to_markdown(const std::string& name) const {
    std::vector<std::pair<std::string_view, long>> sorted{names.begin(), names.end()};
    std::ranges::sort(sorted, [](const auto& a, const auto& b) { return a.second > b.second; });
    std::ostringstream text;
    text << "| " << name << " | " << runs << " | " << went_on << " | " << waits << " |";
    for (const auto& [fault, count] : sorted)
      text << ' ' << fault << ' ' << count << (fault == sorted.back().first ? "" : ",");
    text << " | " << unnamed << " | " << over_limit << " | " << named_ms << " | " << no_force_ms << " | " << late
         << " | " << lost << " |\n";
    return text.str();
  }
};

constexpr const char* header =
    "# What the fault campaign found\n\nHow it is made and what the columns are held to is in "
    "[README.md](README.md#faults-fault_campaign_test). Times are the longest of all runs:\nfrom the cause to the "
    "name, "
    "and from the name until the drive has no force.\n\n"
    "| fault | runs | reached its target | waits to be enabled | named | unnamed | over the limit | named after, ms | "
    "no force "
    "after, ms | late | not recovered |\n|---|---|---|---|---|---|---|---|---|---|---|\n";

std::string what(const NamedFault& fault, std::uint64_t seed, const Outcome& run) {
  std::ostringstream text;
  text << fault.name << ", seed " << seed << ", onset " << hal::seconds(run.onset) << " s: fault "
       << to_string(run.fault) << " after " << hal::seconds(run.until_named) << " s, no force after "
       << hal::seconds(run.until_no_force) << " s, at most " << run.largest_force_N << " N; " << run.last_state;
  return text.str();
}

TEST(FaultCampaign, EveryFaultIsBoundedNamedAndRecovered) {
  const std::array<CampaignNode, 2> nodes{make_node(false), make_node(true)};
  for (const CampaignNode& node : nodes) ASSERT_TRUE(verify(node).ok()) << to_string(verify(node).error);
  const long onsets = from_environment("BREAKAWAY_ONSETS", 40);
  const long first = from_environment("BREAKAWAY_FIRST_ONSET", 0);
  const std::string only = text_from_environment("BREAKAWAY_FAULT");
  std::string table = header;
  const std::vector<NamedFault> faults = named_faults();
  EXPECT_GE(faults.size(), 30U);
  for (std::size_t f = 0; f < faults.size(); ++f) {
    const NamedFault& fault = faults[f];
    if (!only.empty() && fault.name != only) continue;
    Row row;
    for (long i = first; i < first + onsets; ++i) {
      const auto seed = static_cast<std::uint64_t>(i) * 1001 + f;
      const Outcome run = OneRun{nodes[seed % 2], fault, seed}.result();
      row.add(run);
      EXPECT_NE(run.end, End::unnamed) << what(fault, seed, run);
      EXPECT_TRUE(run.stopped_in_time) << what(fault, seed, run);
      EXPECT_TRUE(run.recovered) << what(fault, seed, run);
      if (!fault.foreign_force) {
        EXPECT_LE(run.largest_force_N, FaultWorld::max_force_N * (1 + 1e-6)) << what(fault, seed, run);
      }
    }
    table += row.to_markdown(fault.name);
    std::printf("%s", row.to_markdown(fault.name).c_str());
    std::fflush(stdout);
  }
  const std::string results = text_from_environment("BREAKAWAY_RESULTS");
  if (!results.empty()) std::ofstream{results} << table;
}

}  // namespace
}  // namespace breakaway::campaign
