#include "breakaway/drive_emulator/sdo_server.hpp"

#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

class SdoServerTest : public DriveBench {
 protected:
  void SetUp() override { start(); }
};

TEST_F(SdoServerTest, UploadsOneTwoAndFourBytesExpedited) {
  EXPECT_EQ(sdo({0x40, 0x00, 0x10, 0, 0, 0, 0, 0}), (Bytes{0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00}));
  EXPECT_EQ(sdo({0x40, 0x01, 0x10, 0, 0, 0, 0, 0}), (Bytes{0x4F, 0x01, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sdo({0x40, 0x72, 0x60, 0, 0, 0, 0, 0}), (Bytes{0x4B, 0x72, 0x60, 0, 0xB8, 0x0B, 0, 0}));
  EXPECT_EQ(sdo({0x40, 0x02, 0x65, 0, 0, 0, 0, 0}), (Bytes{0x43, 0x02, 0x65, 0, 0x20, 0x02, 0, 0}));
  EXPECT_EQ(sdo({0x40, 0xC2, 0x60, 2, 0, 0, 0, 0}), (Bytes{0x4F, 0xC2, 0x60, 2, 0xFD, 0, 0, 0}));
  EXPECT_EQ(sdo({0x40, 0x00, 0x12, 1, 0, 0, 0, 0}), (Bytes{0x43, 0x00, 0x12, 1, 0x05, 0x06, 0, 0}));
}

TEST_F(SdoServerTest, AnswersAfterTheResponseDelay) {
  send(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  run(microseconds{199});
  EXPECT_TRUE(sent.empty());
  run(microseconds{1});
  EXPECT_EQ(count(0x585), 1U);
}

TEST_F(SdoServerTest, DownloadsExpeditedWithAndWithoutStatedSize) {
  EXPECT_EQ(sdo({0x2B, 0x17, 0x10, 0, 0xF4, 0x01, 0, 0}), (Bytes{0x60, 0x17, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive->objects().get({0x1017, 0}), 500);
  EXPECT_EQ(sdo({0x22, 0x71, 0x60, 0, 0xFE, 0xFF, 0, 0}), (Bytes{0x60, 0x71, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive->objects().get({0x6071, 0}), -2);
}

TEST_F(SdoServerTest, UploadsATextInSegmentsOfSevenBytes) {
  EXPECT_EQ(sdo({0x40, 0x08, 0x10, 0, 0, 0, 0, 0}), (Bytes{0x41, 0x08, 0x10, 0, 22, 0, 0, 0}));
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x00, 'b', 'e', 'n', 'c', 'h', ' ', 'd'}));
  EXPECT_EQ(sdo({0x70, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x10, 'r', 'i', 'v', 'e', ' ', '0', '1'}));
  EXPECT_EQ(sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x00, '2', '3', '4', '5', '6', '7', '8'}));
  EXPECT_EQ(sdo({0x70, 0, 0, 0, 0, 0, 0, 0}), (Bytes{0x1D, '9', 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(abort_code({0x60, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U);  // nothing left
}

TEST_F(SdoServerTest, DownloadsATextInSegments) {
  EXPECT_EQ(sdo({0x21, 0x03, 0x64, 0, 9, 0, 0, 0}), (Bytes{0x60, 0x03, 0x64, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sdo({0x00, 'A', 'B', 'C', 'D', 'E', 'F', 'G'}), (Bytes{0x20, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sdo({0x1B, 'H', 'I', 0, 0, 0, 0, 0}), (Bytes{0x30, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive->objects().find({0x6403, 0})->text, "ABCDEFGHI");
}

TEST_F(SdoServerTest, DownloadsANumberInOneSegment) {
  expect_written({0x21, 0x71, 0x60, 0, 2, 0, 0, 0});
  EXPECT_EQ(sdo({0x0B, 0x2C, 0x01, 0, 0, 0, 0, 0}), (Bytes{0x20, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive->objects().get({0x6071, 0}), 300);
}

TEST_F(SdoServerTest, AbortsWithTheCodeOfTheCause) {
  EXPECT_EQ(abort_code({0x40, 0x00, 0x20, 0, 0, 0, 0, 0}), 0x06020000U) << "no object, upload";
  EXPECT_EQ(abort_code({0x2F, 0x00, 0x20, 0, 0, 0, 0, 0}), 0x06020000U) << "no object, download";
  EXPECT_EQ(abort_code({0x21, 0x00, 0x20, 0, 9, 0, 0, 0}), 0x06020000U) << "no object, segmented download";
  EXPECT_EQ(abort_code({0x40, 0x18, 0x10, 9, 0, 0, 0, 0}), 0x06090011U) << "no sub-index";
  EXPECT_EQ(abort_code({0x2B, 0x41, 0x60, 0, 0, 0, 0, 0}), 0x06010002U) << "read-only";
  EXPECT_EQ(abort_code({0x21, 0x08, 0x10, 0, 9, 0, 0, 0}), 0x06010002U) << "read-only, segmented";
  EXPECT_EQ(abort_code({0x2F, 0x71, 0x60, 0, 0, 0, 0, 0}), 0x06070010U) << "too short";
  EXPECT_EQ(abort_code({0x23, 0x71, 0x60, 0, 0, 0, 0, 0}), 0x06070010U) << "too long";
  EXPECT_EQ(abort_code({0x2B, 0x5A, 0x60, 0, 9, 0, 0, 0}), 0x06090031U) << "value too high";
  EXPECT_EQ(abort_code({0x2B, 0x5A, 0x60, 0, 0xFF, 0xFF, 0, 0}), 0x06090032U) << "value too low";
  EXPECT_EQ(abort_code({0x2F, 0x60, 0x60, 0, 8, 0, 0, 0}), 0x06090030U) << "mode that 6502h does not offer";
  EXPECT_EQ(abort_code({0x2F, 0x03, 0x10, 0, 1, 0, 0, 0}), 0x06090030U) << "history can only be emptied";
  EXPECT_EQ(abort_code({0x23, 0x05, 0x10, 0, 0x80, 0, 0, 0x40}), 0x06090030U) << "cannot produce SYNC";
  EXPECT_EQ(abort_code({0xA0, 0x08, 0x10, 0, 0, 0, 0, 0}), 0x05040001U) << "block upload";
  EXPECT_EQ(abort_code({0xC6, 0x08, 0x10, 0, 0, 0, 0, 0}), 0x05040001U) << "block download";
  EXPECT_EQ(abort_code({0xE0, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U) << "no such command";
  EXPECT_EQ(abort_code({0x60, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U) << "upload segment without a transfer";
  EXPECT_EQ(abort_code({0x00, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U) << "download segment without a transfer";
}

TEST_F(SdoServerTest, AbortNamesTheObject) {
  EXPECT_EQ(sdo({0x40, 0x18, 0x10, 9, 0, 0, 0, 0}), (Bytes{0x80, 0x18, 0x10, 9, 0x11, 0x00, 0x09, 0x06}));
}

TEST_F(SdoServerTest, AbortsWhenTheToggleBitDoesNotAlternate) {
  sdo({0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(abort_code({0x70, 0, 0, 0, 0, 0, 0, 0}), 0x05030000U);
  EXPECT_EQ(abort_code({0x60, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U) << "the abort ended the transfer";
  sdo({0x21, 0x03, 0x64, 0, 9, 0, 0, 0});
  sdo({0x00, 'A', 'B', 'C', 'D', 'E', 'F', 'G'});
  EXPECT_EQ(abort_code({0x0B, 'H', 'I', 0, 0, 0, 0, 0}), 0x05030000U);
  EXPECT_EQ(drive->objects().find({0x6403, 0})->text, "");
}

TEST_F(SdoServerTest, RefusesASegmentedDownloadOfAnotherLengthThanAnnounced) {
  sdo({0x21, 0x03, 0x64, 0, 9, 0, 0, 0});
  EXPECT_EQ(abort_code({0x01, 'A', 'B', 'C', 'D', 'E', 'F', 'G'}), 0x06070010U) << "ends early";
  sdo({0x21, 0x03, 0x64, 0, 3, 0, 0, 0});
  EXPECT_EQ(abort_code({0x00, 'A', 'B', 'C', 'D', 'E', 'F', 'G'}), 0x06070010U) << "goes on too long";
  EXPECT_EQ(drive->objects().find({0x6403, 0})->text, "");
}

TEST_F(SdoServerTest, ClientsAbortEndsTheTransferUnanswered) {
  sdo({0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_TRUE(sdo({0x80, 0x08, 0x10, 0, 0, 0, 4, 5}).empty());
  EXPECT_EQ(abort_code({0x60, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U);
}

TEST_F(SdoServerTest, ANewTransferReplacesTheOneUnderWay) {
  sdo({0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(sdo({0x40, 0x01, 0x10, 0, 0, 0, 0, 0}).at(0), 0x4FU);
  EXPECT_EQ(abort_code({0x60, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U);
}

TEST_F(SdoServerTest, AbortsATransferThatPausesTooLong) {
  sdo({0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  run(milliseconds{998});
  EXPECT_EQ(count(0x585), 0U);
  run(milliseconds{2});
  EXPECT_EQ(last(0x585), (Bytes{0x80, 0x08, 0x10, 0, 0x00, 0x00, 0x04, 0x05}));
}

TEST_F(SdoServerTest, IgnoresFramesThatAreNotEightBytesLong) { EXPECT_TRUE(sdo({0x40, 0x00, 0x10, 0}).empty()); }

TEST(ObjectDictionary, RefusesToReadAWriteOnlyEntry) {
  ObjectDictionary dictionary;
  dictionary.add({0x2000, 0}, {.type = Type::u8, .access = Access::write_only});
  SdoServer server{dictionary};
  EXPECT_EQ(*server.answer({0x40, 0x00, 0x20, 0}), (SdoServer::Payload{0x80, 0x00, 0x20, 0, 0x01, 0x00, 0x01, 0x06}));
  EXPECT_EQ(*server.answer({0x2F, 0x00, 0x20, 0, 7}), (SdoServer::Payload{0x60, 0x00, 0x20, 0}));
  EXPECT_EQ(dictionary.get({0x2000, 0}), 7);
}

TEST(ObjectDictionary, KeepsTheSignOfEveryWidth) {
  ObjectDictionary dictionary;
  dictionary.add({0x2000, 1}, {.type = Type::i8, .access = Access::read_write});
  dictionary.add({0x2000, 2}, {.type = Type::i32, .access = Access::read_write});
  dictionary.add({0x2000, 3}, {.type = Type::u32, .access = Access::read_write});
  const std::uint8_t ones[] = {0xFF, 0xFF, 0xFF, 0xFF};
  EXPECT_FALSE(dictionary.write({0x2000, 1}, std::span{ones}.first(1)));
  EXPECT_FALSE(dictionary.write({0x2000, 2}, ones));
  EXPECT_FALSE(dictionary.write({0x2000, 3}, ones));
  EXPECT_EQ(dictionary.get({0x2000, 1}), -1);
  EXPECT_EQ(dictionary.get({0x2000, 2}), -1);
  EXPECT_EQ(dictionary.get({0x2000, 3}), 0xFFFFFFFF);
}

}  // namespace
}  // namespace breakaway::drive_emulator
