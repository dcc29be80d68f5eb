// RunningNode: the whole node for Linux on the scenarios of the project, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "../unit/scratch_folder.hpp"
#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "node_host.hpp"
#include "options.hpp"
#include "telemetry.hpp"

namespace breakaway::closed_loop {

using firmware::AxisFault;

inline const std::string scenarios = BREAKAWAY_SOURCE_DIR "/sim/scenarios/";

class RunningNode : public testing::ScratchFolder {
 protected:
  // A scenario of the project with one change.
  std::string changed(const std::string& name, const std::string& from, const std::string& to) const {
    std::ostringstream text;
    text << std::ifstream{scenarios + name}.rdbuf();
    std::string content = text.str();
    const auto at = content.find(from);
    EXPECT_NE(at, content.npos) << from;
    std::ofstream{path(name)} << content.replace(at, from.size(), to);
    return path(name);
  }

  // The node of this file; at_wake_up sees its world whenever the node wakes.
  NodeEnd run(
      const std::string& file, const std::function<void()>& at_wake_up = [] {}) {
    const scenario::Scenario s = scenario::read_scenario(file);
    NodeHost host{s};
    host_ = &host;
    enabled_at_.reset();
    acted_until_s_ = -1;
    named_.clear();
    fault_ = AxisFault::none;
    force_share_ = 0;
    position_m_.clear();
    host.at_wake_up = [&] {
      for (std::size_t axis = 0; axis < s.axes(); ++axis)
        force_share_ = std::max(force_share_, std::abs(host.force_N(axis)) / s.node.axes[axis].controller.max_force_N);
      if (!enabled_at_ && host.holds_axis(0)) enabled_at_ = host.now();
      read_records();
      at_wake_up();
    };
    options_.configuration = file;
    options_.interface = "can0";
    const NodeEnd end = run_node(options_, *telemetry_);
    EXPECT_LE(force_share_, 1 + 1e-9) << "of the limit";
    for (std::size_t axis = 0; axis < s.axes(); ++axis) {
      EXPECT_FALSE(host.holds_axis(axis)) << "it is left enabled";
      position_m_.push_back(host.state(axis).position_m);
    }
    return end;
  }
  // What it says instead of running; empty: it runs.
  std::string refusal(
      const std::string& file, const std::function<void()>& at_wake_up = [] {}) {
    try {
      run(file, at_wake_up);
    } catch (const InputError& error) {
      EXPECT_EQ(force_share_, 0) << "nothing may have moved";
      return error.what();
    }
    return {};
  }
  // Since the first drive was enabled; before, less than nothing.
  double running_s() const { return enabled_at_ ? hal::seconds(host_->now() - *enabled_at_) : -1.0; }
  // It is so long after that, and a drive makes force.
  bool makes_force_between(double from_s, double until_s) const {
    if (!(running_s() > from_s && running_s() < until_s)) return false;
    for (std::size_t axis = 0; axis < host_->axes(); ++axis)
      if (host_->force_N(axis) != 0) return true;
    return false;
  }
  // Once, when the first drive has been enabled for so long.
  void at(double time_s, const std::function<void()>& act) {
    if (running_s() < time_s || time_s <= acted_until_s_) return;
    acted_until_s_ = time_s;
    act();
  }

  NodeHost* host_ = nullptr;  // of the run that is under way
  linux_node::Options options_;
  std::unique_ptr<linux_node::Telemetry> telemetry_ = std::make_unique<linux_node::Telemetry>();
  double force_share_ = 0;          // of the limit of its axis, at most, at any wake-up
  std::vector<double> position_m_;  // of the axes, at the end
  std::set<AxisFault> named_;
  AxisFault fault_ = AxisFault::none;  // of the first axis, in its last step

 private:
  // What the thread that writes logs and lines would take.
  void read_records() {
    for (linux_node::Record record; telemetry_->records.pop(record);)
      if (const auto* step = std::get_if<linux_node::StepRecord>(&record)) note(*step);
  }

  void note(const linux_node::StepRecord& step) {
    if (step.axis == 0) fault_ = step.fault;
    if (step.fault != AxisFault::none) named_.insert(step.fault);
  }

  std::optional<hal::Time> enabled_at_;
  double acted_until_s_ = -1;
};

}  // namespace breakaway::closed_loop
