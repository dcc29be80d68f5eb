// What can be said of the kernel's socket on any machine: a machine for tests may have no CAN.
#include "breakaway/socketcan/kernel_socket.hpp"

#include <gtest/gtest.h>

namespace {

using namespace breakaway::socketcan;

TEST(KernelSocket, NamesThatCannotBeInterfacesAreRefused) {
  KernelSocket socket;
  for (const char* name : {"", "a-name-that-is-too-long"})
    EXPECT_EQ(socket.open(name, {}), OpenResult::no_such_interface) << name;
}

TEST(KernelSocket, AnInterfaceThatIsNotCanIsNotOpened) {
  KernelSocket socket;
  const OpenResult result = socket.open("lo", {});
  EXPECT_TRUE(result == OpenResult::not_can || result == OpenResult::no_can_support) << to_string(result);
  can_frame frame{};
  breakaway::hal::Time time{};
  EXPECT_EQ(socket.read(frame, time), Io::gone);
  EXPECT_EQ(socket.write(frame), Io::gone);
  EXPECT_FALSE(socket.on_bus());
  EXPECT_FALSE(socket.reopen());
}

TEST(KernelSocket, EveryResultHasARemedy) {
  for (int r = 1; r <= static_cast<int>(OpenResult::failed); ++r)
    EXPECT_NE(to_string(static_cast<OpenResult>(r)), "unknown result");
}

}  // namespace
