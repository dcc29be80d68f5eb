// Whatever happens to the node for Linux and to its bus, an axis whose fault was named has no force until its operator
// has seen it. Random faults at random times, each run by its number.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "running_node.hpp"

namespace breakaway::closed_loop {
namespace {

using namespace std::chrono_literals;

class FaultyNode : public RunningNode {
 protected:
  void run_number(unsigned number) {
    random_.seed(number);
    const std::string name = names_[below(std::size(names_))];
    SCOPED_TRACE(name + ", number " + std::to_string(number));
    options_ = {};
    options_.duration_s = 1 + 4 * share();
    telemetry_->stop = telemetry_->reset = false;
    bus_back_s_ = power_back_s_ = never;
    faulty_since_s_ = never;
    std::vector<double> times(1 + below(5));
    std::generate(times.begin(), times.end(), [&] { return 5 * share(); });
    std::sort(times.rbegin(), times.rend());
    try {
      run(scenarios + name + ".toml", [&] {
        mend();
        while (!times.empty() && now_s() > times.back()) {
          times.pop_back();
          break_something();
        }
        expect_no_force_after_a_fault();
      });
    } catch (const InputError&) {  // it has not begun
    }
  }

 private:
  static constexpr double never = 1e9;
  // Of a drive that nobody reaches: until it misses the heartbeat of the node.
  static constexpr double patience_s = 0.35;

  double now_s() const { return hal::seconds(host_->now()); }
  double share() { return std::uniform_real_distribution<double>{0, 1}(random_); }
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(share() * static_cast<double>(end)); }
  hal::Duration up_to(hal::Duration longest) { return std::chrono::duration_cast<hal::Duration>(longest * share()); }

  void mend() {
    if (now_s() > bus_back_s_) {
      host_->port().set_bus_state(hal::BusState::error_active);
      bus_back_s_ = never;
    }
    if (now_s() > power_back_s_) {
      host_->drive(0).power_on(host_->now());
      power_back_s_ = never;
    }
  }

  void break_something() {
    switch (below(7)) {
      case 0:
        return host_->oversleep(up_to(20ms));
      case 1:
        return host_->oversleep(up_to(3s));
      case 2:
        host_->port().set_bus_state(hal::BusState::bus_off);
        bus_back_s_ = now_s() + share();
        return;
      case 3:
        if (power_back_s_ < never) return;
        host_->drive(0).power_off(host_->now());
        power_back_s_ = now_s() + 2 * share();
        return;
      case 4:
        telemetry_->reset = true;
        return;
      case 5:
        return write_to_drive(0x6040, static_cast<std::uint8_t>(below(256)));
      default:
        return say(canopen::nmt_frame(nmt_commands_[below(std::size(nmt_commands_))], 1));
    }
  }
  void write_to_drive(std::uint16_t index, std::uint8_t value) {
    hal::CanFrame frame{.id = canopen::sdo_request_cob_id(1), .size = 8, .data = {0x2B}};  // two bytes, at once
    canopen::store_little_endian(frame.data, index, 1);
    frame.data[4] = value;
    say(frame);
  }
  void say(const hal::CanFrame& frame) { static_cast<void>(host_->other_tool().send(frame, hal::Time::max())); }

  void expect_no_force_after_a_fault() {
    if (fault_ == AxisFault::none)
      faulty_since_s_ = never;
    else
      faulty_since_s_ = std::min(faulty_since_s_, now_s());
    if (now_s() > faulty_since_s_ + patience_s) {
      EXPECT_EQ(host_->force_N(0), 0) << to_string(fault_);
    }
  }

  static constexpr const char* names_[] = {"braked_axis", "can_axis",      "move_axis",  "presliding_axis", "belt_axis",
                                           "fine_axis",   "polled_odrive", "three_axes", "coupled_gantry"};
  static constexpr canopen::NmtCommand nmt_commands_[] = {
      canopen::NmtCommand::stop, canopen::NmtCommand::enter_pre_operational, canopen::NmtCommand::reset_node};
  std::mt19937 random_;
  double bus_back_s_ = never, power_back_s_ = never, faulty_since_s_ = never;
};

TEST_F(FaultyNode, MakesNoForceOnceItHasNamedAFault) {
  for (unsigned number = 0; number < 100; ++number) run_number(number);
}

}  // namespace
}  // namespace breakaway::closed_loop
