// What a user reads when a call of canopen fails.
#include <gtest/gtest.h>

#include "../explained_enum.hpp"
#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/canopen/sdo_client.hpp"

namespace breakaway::canopen {
namespace {

TEST(SdoStart, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<SdoStart>({{SdoStart::started, {"started"}},
                                    {SdoStart::busy, {"not finished", "wait until poll()", "cancel()"}},
                                    {SdoStart::bad_length, {"bytes must hold 1 to SdoClient::capacity"}}});
}

TEST(SdoResult, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<SdoResult>(
      {{SdoResult::done, {"done"}},
       {SdoResult::busy, {"not finished", "ask poll() again"}},
       {SdoResult::timeout, {"did not answer in time", "check node_id", "wiring", "raise the timeout"}},
       {SdoResult::aborted, {"aborted", "to_string(abort_code())"}},
       {SdoResult::protocol_error, {"CiA 301 forbids", "look for a second node"}}});
}

TEST(BusFit, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<BusFit>(
      {{BusFit::fits, {"fit the bus"}},
       {BusFit::axes_out_of_range, {"axes must be 1 to 127"}},
       {BusFit::period_out_of_range, {"period must be above 0 and at most 1 hour"}},
       {BusFit::bit_rate_out_of_range, {"bit_rate must be 10000 to 1000000 bit/s"}},
       {BusFit::overloaded, {"do not fit", "longer period", "higher bit_rate", "fewer axes"}}});
}

TEST(SdoAbort, NoneAndWhatNobodyKnowsHaveAText) {
  EXPECT_EQ(to_string(SdoAbort::none), "not aborted");
  EXPECT_EQ(to_string(SdoAbort{0x0601'0000}), "unsupported access to the object");
  EXPECT_EQ(to_string(SdoAbort{0x1234'5678}), "unknown SDO abort code");
}

}  // namespace
}  // namespace breakaway::canopen
