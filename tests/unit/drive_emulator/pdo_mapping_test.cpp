#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

class PdoMappingTest : public DriveBench {
 protected:
  void SetUp() override { start(); }
  void invalidate_rpdo1() { expect_written({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0x00, 0x80}); }
  void empty_rpdo1() { expect_written({0x2F, 0x00, 0x16, 0, 0, 0, 0, 0}); }
  void map_rpdo1(std::initializer_list<std::uint32_t> entries) {
    unsigned sub = 0;
    for (const std::uint32_t entry : entries)
      expect_written(
          {0x23, 0x00, 0x16, ++sub, entry & 0xFF, (entry >> 8) & 0xFF, (entry >> 16) & 0xFF, (entry >> 24) & 0xFF});
  }
};

TEST_F(PdoMappingTest, FollowsTheSequenceOfTheStandard) {
  configure_cyclic_torque();
  EXPECT_EQ(drive->objects().get({0x1600, 0}), 2);
  EXPECT_EQ(drive->objects().get({0x1A00, 0}), 3);
  EXPECT_EQ(drive->objects().get({0x1400, 1}), 0x205);
}

TEST_F(PdoMappingTest, RefusesChangesWhileThePdoExists) {
  EXPECT_EQ(abort_code({0x2F, 0x00, 0x16, 0, 0, 0, 0, 0}), 0x08000022U);
  EXPECT_EQ(abort_code({0x23, 0x00, 0x16, 1, 0x10, 0, 0x71, 0x60}), 0x08000022U);
  EXPECT_EQ(abort_code({0x23, 0x00, 0x14, 1, 0x06, 0x02, 0, 0}), 0x08000022U) << "another identifier";
  EXPECT_EQ(abort_code({0x2B, 0x00, 0x18, 3, 1, 0, 0, 0}), 0x08000022U) << "inhibit time";
}

TEST_F(PdoMappingTest, RefusesEntriesWhileTheCountIsNotZero) {
  invalidate_rpdo1();
  EXPECT_EQ(abort_code({0x23, 0x00, 0x16, 1, 0x10, 0, 0x71, 0x60}), 0x08000022U);
}

TEST_F(PdoMappingTest, RefusesWhatCannotBeMapped) {
  invalidate_rpdo1();
  empty_rpdo1();
  EXPECT_EQ(abort_code({0x23, 0x00, 0x16, 1, 0x10, 0, 0x41, 0x60}), 0x06040041U) << "statusword received";
  EXPECT_EQ(abort_code({0x23, 0x00, 0x16, 1, 0x20, 0, 0x00, 0x10}), 0x06040041U) << "device type";
  EXPECT_EQ(abort_code({0x23, 0x00, 0x16, 1, 0x08, 0, 0x71, 0x60}), 0x06040041U) << "wrong length";
  EXPECT_EQ(abort_code({0x23, 0x00, 0x16, 1, 0x10, 0, 0x00, 0x20}), 0x06020000U) << "no such object";
}

TEST_F(PdoMappingTest, RefusesMoreThanEightBytes) {
  invalidate_rpdo1();
  empty_rpdo1();
  map_rpdo1({0x60400010, 0x60710010, 0x60B20010, 0x60720010, 0x60600008});
  EXPECT_EQ(abort_code({0x2F, 0x00, 0x16, 0, 5, 0, 0, 0}), 0x06040042U) << "72 bits";
  EXPECT_EQ(abort_code({0x2F, 0x00, 0x16, 0, 9, 0, 0, 0}), 0x06040042U) << "nine objects";
  expect_written({0x2F, 0x00, 0x16, 0, 4, 0, 0, 0});
}

TEST_F(PdoMappingTest, RefusesACountBeyondTheEntriesThatAreSet) {
  invalidate_rpdo1();
  empty_rpdo1();
  EXPECT_EQ(abort_code({0x2F, 0x00, 0x16, 0, 2, 0, 0, 0}), 0x06020000U);
}

TEST_F(PdoMappingTest, RefusesRestrictedIdentifiersAndReservedTypes) {
  invalidate_rpdo1();
  EXPECT_EQ(abort_code({0x23, 0x00, 0x14, 1, 0x00, 0x00, 0, 0}), 0x06090030U) << "NMT";
  EXPECT_EQ(abort_code({0x23, 0x00, 0x14, 1, 0x05, 0x06, 0, 0}), 0x06090030U) << "SDO";
  EXPECT_EQ(abort_code({0x23, 0x00, 0x14, 1, 0x05, 0x07, 0, 0}), 0x06090030U) << "heartbeat";
  EXPECT_EQ(abort_code({0x23, 0x00, 0x14, 1, 0x05, 0x02, 0, 0x20}), 0x06090030U) << "29-bit identifier";
  EXPECT_EQ(abort_code({0x2F, 0x00, 0x14, 2, 241, 0, 0, 0}), 0x06090030U);
  EXPECT_EQ(abort_code({0x2F, 0x00, 0x14, 2, 253, 0, 0, 0}), 0x06090030U);
  for (const unsigned type : {0U, 1U, 240U, 254U, 255U}) expect_written({0x2F, 0x00, 0x14, 2, type, 0, 0, 0});
  expect_written({0x23, 0x00, 0x14, 1, 0x07, 0x02, 0, 0});
}

TEST_F(PdoMappingTest, ListensOnTheNewIdentifierOnly) {
  configure_cyclic_torque();
  invalidate_rpdo1();
  expect_written({0x2F, 0x00, 0x14, 2, 255, 0, 0, 0});
  expect_written({0x23, 0x00, 0x14, 1, 0x45, 0x02, 0, 0});
  send(0x205, {0x06, 0, 0, 0});
  EXPECT_EQ(drive->state(), cia402::State::switch_on_disabled);
  send(0x245, {0x06, 0, 0, 0});
  EXPECT_EQ(drive->state(), cia402::State::ready_to_switch_on);
}

}  // namespace
}  // namespace breakaway::drive_emulator
