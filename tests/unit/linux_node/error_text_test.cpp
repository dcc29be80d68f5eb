#include "error_text.hpp"

#include <gtest/gtest.h>

namespace breakaway::linux_node {
namespace {

TEST(ErrorText, SaysWhatTheCodeIsAboutAndWhichBitsOfTheRegisterAreSet) {
  EXPECT_EQ(error_text(0x2310, 0), "error code 2310h: current on the output side");
  EXPECT_EQ(error_text(0x8130, 0x11), "error code 8130h: communication; error register 11h: generic, communication");
  EXPECT_EQ(error_text(0xFF01, 0x80), "error code FF01h: the vendor's own; error register 80h: manufacturer");
}

TEST(ErrorText, OfAStepIsThatOfItsDrive) {
  StepRecord canopen{.fault_code = 0x2310, .error_register = 0x01, .statusword = 0x0240};
  EXPECT_EQ(error_text(canopen), "error code 2310h: current on the output side; error register 01h: generic");
  EXPECT_EQ(why_disabled(canopen).find("statusword 0240h, "), 0U) << why_disabled(canopen);
  StepRecord other{.fault_code = 14, .code_text = "too hot", .setup_text = "waits"};
  EXPECT_EQ(error_text(other), "too hot");
  EXPECT_EQ(why_disabled(other), "waits");
}

}  // namespace
}  // namespace breakaway::linux_node
