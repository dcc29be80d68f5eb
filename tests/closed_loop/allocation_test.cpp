// A loop step allocates nothing: every way to the heap is closed while one runs, through set-up, motion, faults and
// recovery.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include "rig.hpp"

namespace {
thread_local bool in_step = false;

void refuse_in_step() {
  if (!in_step) return;
  in_step = false;
  std::fputs("heap allocation in a loop step\n", stderr);
  std::abort();
}
}  // namespace

// glibc's own entry points under other names: what is defined here takes the place of malloc for the whole process, the
// C++ runtime included, because operator new ends in malloc.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  refuse_in_step();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  refuse_in_step();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  refuse_in_step();
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  refuse_in_step();
  return __libc_memalign(alignment, size);
}
}

namespace breakaway::closed_loop {
namespace {

struct Guard {
  Guard() { in_step = true; }
  ~Guard() { in_step = false; }
};

// The simulated world around the step may allocate; the flashed step may not.
void guarded_steps(Rig& rig, int steps) {
  for (int i = 0; i < steps; ++i) {
    rig.advance_world();
    {
      const Guard guard;
      rig.loop_step();
    }
    rig.release_brakes();
  }
}

TEST(LoopStep, AllocatesNothingInAnyState) {
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

using LoopStepDeathTest = ::testing::Test;

TEST_F(LoopStepDeathTest, GuardFiresOnNewAndOnMalloc) {
  EXPECT_DEATH(
      {
        const Guard guard;
        static_cast<void>(::operator new(8));
      },
      "heap allocation in a loop step");
  EXPECT_DEATH(
      {
        const Guard guard;
        void* volatile memory = std::malloc(8);
        std::free(memory);
      },
      "heap allocation in a loop step");
}

}  // namespace
}  // namespace breakaway::closed_loop
