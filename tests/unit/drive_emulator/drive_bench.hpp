// A drive emulator on a bench, operated by hand: the tests write every byte of their frames themselves.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <vector>

#include "breakaway/drive_emulator/drive_emulator.hpp"

namespace breakaway::drive_emulator {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// Stays where the test puts it; adds up the impulse of the force exactly.
class BenchMechanism final : public Mechanism {
 public:
  void advance_to(double time_s, const model::AppliedForce& force) override {
    const double tau_s = force.time_constant_s;
    impulse_Ns += force.constant_N * (time_s - time_s_);
    if (force.transient_N != 0) impulse_Ns += tau_s * (force.transient_at_N(time_s_) - force.transient_at_N(time_s));
    time_s_ = time_s;
  }
  double position_m() const override { return position; }

  double position = 0;
  double impulse_Ns = 0;

 private:
  double time_s_ = 0;
};

struct SentFrame {
  hal::CanFrame frame;
  hal::Time at{};
};

using Bytes = std::vector<unsigned>;

inline Bytes bytes_of(const hal::CanFrame& frame) { return {frame.data.begin(), frame.data.begin() + frame.size}; }

// Node 5 with 1 Nm rated torque and 10 N/Nm, so that 1 per mille is 0.01 N, and 1 um encoder counts.
inline EmulatorConfig bench_config() {
  EmulatorConfig config;
  config.node_id = 5;
  config.force_per_torque_N_per_Nm = 10.0;
  config.device_name = "bench drive 0123456789";
  return config;
}

class DriveBench : public ::testing::Test {
 protected:
  // Powers the drive on at time 0 and runs past its boot-up message, which is dropped.
  void start(const EmulatorConfig& config = bench_config()) {
    drive.emplace(config, mechanism, [this](const hal::CanFrame& frame, hal::Time at) { sent.push_back({frame, at}); });
    drive->power_on(hal::Time{});
    run(milliseconds{10});
    sent.clear();
  }

  void run(hal::Duration duration) {
    now += duration;
    drive->advance_to(now);
  }

  void send(std::uint16_t id, std::initializer_list<unsigned> data) {
    hal::CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(data.size())};
    std::size_t i = 0;
    for (const unsigned byte : data) frame.data[i++] = static_cast<std::uint8_t>(byte);
    drive->on_frame(frame, now);
  }

  // The answer to an SDO request; empty if there is none.
  Bytes sdo(std::initializer_list<unsigned> request) {
    sent.clear();
    send(0x605, request);
    run(milliseconds{1});
    const Bytes answer = last(0x585);
    sent.clear();
    return answer;
  }

  void expect_written(std::initializer_list<unsigned> request) { EXPECT_EQ(sdo(request).at(0), 0x60U); }

  // The abort code that an SDO request is answered with; 0 if it is not an abort.
  std::uint32_t abort_code(std::initializer_list<unsigned> request) {
    const Bytes answer = sdo(request);
    return answer.at(0) == 0x80 ? answer[4] | answer[5] << 8 | answer[6] << 16 | answer[7] << 24 : 0;
  }

  // Data of the newest frame with this identifier since `sent` was emptied; empty if there is none.
  Bytes last(std::uint16_t id) const {
    for (auto entry = sent.rbegin(); entry != sent.rend(); ++entry)
      if (entry->frame.id == id) return bytes_of(entry->frame);
    return {};
  }
  std::size_t count(std::uint16_t id) const {
    std::size_t found = 0;
    for (const SentFrame& entry : sent) found += entry.frame.id == id ? 1 : 0;
    return found;
  }

  unsigned statusword() {
    const Bytes answer = sdo({0x40, 0x41, 0x60, 0, 0, 0, 0, 0});
    return answer.at(4) | answer.at(5) << 8;
  }
  void controlword(unsigned word) { expect_written({0x2B, 0x40, 0x60, 0, word & 0xFF, word >> 8, 0, 0}); }
  void set_torque_mode() { expect_written({0x2F, 0x60, 0x60, 0, 10, 0, 0, 0}); }
  void target_torque(int per_mille) {
    const auto word = static_cast<unsigned>(per_mille) & 0xFFFFU;
    expect_written({0x2B, 0x71, 0x60, 0, word & 0xFF, word >> 8, 0, 0});
  }
  void enable() {
    set_torque_mode();
    for (const unsigned word : {0x06U, 0x07U, 0x0FU}) controlword(word);
    ASSERT_EQ(drive->state(), cia402::State::operation_enabled);
  }
  double force_N() const { return drive->force().constant_N; }

  // RPDO1: 6040h, 6071h at every SYNC. TPDO1: 6041h, 6064h, 6077h with every SYNC. Then NMT start.
  void configure_cyclic_torque() {
    expect_written({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0x00, 0x80});
    expect_written({0x2F, 0x00, 0x14, 2, 1, 0, 0, 0});
    expect_written({0x2F, 0x00, 0x16, 0, 0, 0, 0, 0});
    expect_written({0x23, 0x00, 0x16, 1, 0x10, 0x00, 0x40, 0x60});
    expect_written({0x23, 0x00, 0x16, 2, 0x10, 0x00, 0x71, 0x60});
    expect_written({0x2F, 0x00, 0x16, 0, 2, 0, 0, 0});
    expect_written({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0x00, 0x00});
    expect_written({0x23, 0x00, 0x18, 1, 0x85, 0x01, 0x00, 0x80});
    expect_written({0x2F, 0x00, 0x18, 2, 1, 0, 0, 0});
    expect_written({0x2F, 0x00, 0x1A, 0, 0, 0, 0, 0});
    expect_written({0x23, 0x00, 0x1A, 1, 0x10, 0x00, 0x41, 0x60});
    expect_written({0x23, 0x00, 0x1A, 2, 0x20, 0x00, 0x64, 0x60});
    expect_written({0x23, 0x00, 0x1A, 3, 0x10, 0x00, 0x77, 0x60});
    expect_written({0x2F, 0x00, 0x1A, 0, 3, 0, 0, 0});
    expect_written({0x23, 0x00, 0x18, 1, 0x85, 0x01, 0x00, 0x00});
    send(0x000, {0x01, 5});
  }
  void rpdo(unsigned word, int per_mille) {
    const auto torque = static_cast<unsigned>(per_mille) & 0xFFFFU;
    send(0x205, {word & 0xFF, word >> 8, torque & 0xFF, torque >> 8});
  }
  void sync() { send(0x080, {}); }
  // One cycle of 1 ms: the SYNC, the answer, and in its middle the next command.
  void cycle(unsigned word, int per_mille) {
    sync();
    run(microseconds{500});
    rpdo(word, per_mille);
    run(microseconds{500});
  }
  void enable_cyclic() {
    set_torque_mode();
    configure_cyclic_torque();
    for (const unsigned word : {0x06U, 0x07U, 0x0FU, 0x0FU}) cycle(word, 0);
    ASSERT_EQ(drive->state(), cia402::State::operation_enabled);
    sent.clear();
  }

  BenchMechanism mechanism;
  std::vector<SentFrame> sent;
  std::optional<DriveEmulator> drive;
  hal::Time now{};
};

}  // namespace breakaway::drive_emulator
