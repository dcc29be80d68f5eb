// A loop step calls nothing that can wait: heap, locks and the system are closed while one runs, through set-up,
// motion, faults and recovery. The fault campaign runs under the same guard.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <mutex>

#include "../realtime_guard.hpp"
#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

using testing::RealtimeGuard;

// The simulated world around the step may wait; the flashed step may not.
void guarded_steps(Rig& rig, int steps) {
  for (int i = 0; i < steps; ++i) {
    rig.advance_world();
    {
      const RealtimeGuard guard;
      rig.loop_step();
    }
    rig.release_brakes();
  }
}

TEST(RealtimeStep, WaitsForNothingInAnyState) {
  Rig rig{{.start_m = -0.01}};
  rig.loop().request_enable(rig.id(0));
  guarded_steps(rig, 3000);
  ASSERT_EQ(rig.status(0).output.mode, law::Mode::hold) << "set up, enabled, settled";
  rig.loop().set_target_m(rig.id(0), 0.002F);
  guarded_steps(rig, 1000);
  rig.drive(0).trip_fault(0x2310, rig.now());
  guarded_steps(rig, 200);
  ASSERT_EQ(rig.status(0).fault, firmware::AxisFault::emergency);
  rig.loop().reset_fault(rig.id(0));
  guarded_steps(rig, 1000);
  EXPECT_TRUE(rig.status(0).running);
}

TEST(RealtimeGuardDeathTest, EndsAStepThatAllocates) {
  const auto allocate_by_new = [] {
    const RealtimeGuard guard;
    ::operator delete(::operator new(8));
  };
  const auto allocate_by_malloc = [] {
    const RealtimeGuard guard;
    void* volatile memory = std::malloc(8);
    std::free(memory);
  };
  EXPECT_DEATH(allocate_by_new(), "heap allocation in a real-time step");
  EXPECT_DEATH(allocate_by_malloc(), "heap allocation in a real-time step");
}

TEST(RealtimeGuardDeathTest, EndsAStepThatGivesMemoryBack) {
  void* volatile memory = std::malloc(8);
  const auto release = [&] {
    const RealtimeGuard guard;
    std::free(memory);
  };
  EXPECT_DEATH(release(), "release of heap memory in a real-time step");
  std::free(memory);
}

TEST(RealtimeGuardDeathTest, EndsAStepThatThrows) {
  const auto fail = [] {
    const RealtimeGuard guard;
    try {
      throw 1;
    } catch (int) {
    }
  };
  EXPECT_DEATH(fail(), "heap allocation in a real-time step");
}

TEST(RealtimeGuardDeathTest, EndsAStepThatLocks) {
  std::mutex mutex;
  const auto lock = [&] {
    const RealtimeGuard guard;
    const std::scoped_lock held{mutex};
  };
  EXPECT_DEATH(lock(), "lock in a real-time step");
}

TEST(RealtimeGuardDeathTest, EndsAStepThatCallsTheSystem) {
  if (!RealtimeGuard::sees_system_calls()) GTEST_SKIP() << "this machine cannot watch system calls";
  const auto call = [] {
    const RealtimeGuard guard;
    static_cast<void>(getppid());
  };
  EXPECT_DEATH(call(), "system call in a real-time step");
}

}  // namespace
}  // namespace breakaway::closed_loop
