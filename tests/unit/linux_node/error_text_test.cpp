#include "error_text.hpp"

#include <gtest/gtest.h>

namespace breakaway::linux_node {
namespace {

TEST(ErrorText, SaysWhatTheCodeIsAboutAndWhichBitsOfTheRegisterAreSet) {
  EXPECT_EQ(error_text(0x2310, 0), "error code 2310h: current on the output side");
  EXPECT_EQ(error_text(0x8130, 0x11), "error code 8130h: communication; error register 11h: generic, communication");
  EXPECT_EQ(error_text(0xFF01, 0x80), "error code FF01h: the vendor's own; error register 80h: manufacturer");
}

}  // namespace
}  // namespace breakaway::linux_node
