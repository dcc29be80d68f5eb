// Positions and forces as the controller has them: their scale, sign, datum and time.
#include "drive_fixture.hpp"

namespace breakaway::test {
namespace {

TEST_F(DriveTest, FeedbackIsFreshOncePerSampleAndCarriesTheTimeOfItsSync) {
  set_up();
  node.counts = 1234;
  node.torque = -40;
  step();
  const Time sync = now;
  step();
  EXPECT_TRUE(feedback.fresh);
  EXPECT_TRUE(feedback.ever_valid);
  EXPECT_EQ(feedback.sample_time, sync);
  EXPECT_FLOAT_EQ(feedback.position_m, 1234e-6F);
  EXPECT_FLOAT_EQ(feedback.force_N, -2.0F);
  EXPECT_TRUE(drive.feedback().fresh) << "the sample of the second period";
  EXPECT_FALSE(drive.feedback().fresh);
}

TEST_F(DriveTest, SampleWithoutKnownSyncHasTheTimeOfItsFrame) {
  set_up();
  now += 1s;  // the last SYNC is long ago
  CanFrame frame{.id = tpdo_cob_id(1, node_id), .size = 8, .data = {}};
  drive.on_frame({.frame = frame, .time = now});
  EXPECT_EQ(drive.feedback().sample_time, now);
}

TEST_F(DriveTest, OffsetFromTheDatumIsExactAcrossTheEndOfTheRange) {
  set_up();
  constexpr auto highest = std::numeric_limits<std::int32_t>::max();
  constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
  struct Row {
    std::int32_t datum, counts;
    float offset_m;
  };
  for (const Row& row : {Row{highest, lowest, 1e-6F}, Row{lowest, highest, -1e-6F}, Row{highest - 1, highest, 1e-6F},
                         Row{100, 97, -3e-6F}, Row{2'000'000'001, 2'000'000'003, 2e-6F}}) {
    drive.set_datum_counts(row.datum);
    node.counts = row.counts;
    step();
    EXPECT_FLOAT_EQ(drive.feedback().position_offset_m, row.offset_m) << row.datum;
  }
}

TEST_F(DriveTest, TravelIsExactToTheCountAcrossTheEndOfTheRangeAndNotCountedAcrossAReboot) {
  constexpr auto highest = std::numeric_limits<std::int32_t>::max();
  constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
  node.counts = 7'000'000;
  set_up();
  EXPECT_EQ(feedback.travel_m, 0) << "the first reading is no travel";
  node.counts = highest - 3;
  run_for(5ms);
  struct Row {
    std::int32_t counts;
    float travel_m;
  };
  for (const Row& row : {Row{highest, 3e-6F}, Row{lowest, 1e-6F}, Row{lowest + 4, 4e-6F}, Row{highest, -5e-6F}}) {
    node.counts = row.counts;
    step();  // asks for it
    step();
    EXPECT_FLOAT_EQ(feedback.travel_m, row.travel_m) << row.counts;
    step();
    EXPECT_EQ(feedback.travel_m, 0);
  }
  node.counts = 0;
  set_up();
  EXPECT_EQ(feedback.travel_m, 0);
}

TEST_F(DriveTest, TellsWhatItSharesWithTheController) {
  EXPECT_EQ(drive.encoder_resolution_m(), scale.encoder_resolution_m);
  EXPECT_EQ(drive.max_force_N(), scale.max_force_N) << "until the drive's own limit is known";
  EXPECT_EQ(drive.node_id(), node_id);
}

TEST_F(DriveTest, CountsOfAPositionSaturate) {
  EXPECT_EQ(drive.counts_at(0.001F), 1000);
  EXPECT_EQ(drive.counts_at(-0.0000014F), -1);
  EXPECT_EQ(drive.counts_at(1e9F), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(drive.counts_at(-1e9F), std::numeric_limits<std::int32_t>::min());
}

class InvertedDriveTest : public DriveTest {
 protected:
  static DriveConfig<float> inverted() {
    DriveConfig<float> changed = config;
    changed.invert_direction = true;
    return changed;
  }
  InvertedDriveTest() : DriveTest{inverted()} {}
};

TEST_F(InvertedDriveTest, ForceAndPositionChangeSignTogether) {
  enable();
  node.counts = 500;
  node.torque = 20;
  step(10.0F);
  step();
  EXPECT_EQ(drive.counts_at(-500e-6F), -500);
  EXPECT_EQ(drive.position_counts(), -500);
  drive.set_datum_counts(-400);
  EXPECT_FLOAT_EQ(feedback.position_m, -500e-6F);
  EXPECT_FLOAT_EQ(drive.feedback().position_offset_m, -100e-6F);
  EXPECT_FLOAT_EQ(feedback.force_N, -1.0F);
  step(10.0F);
  node.counts = 800;
  step(10.0F);
  step(10.0F);
  EXPECT_FLOAT_EQ(feedback.travel_m, -300e-6F);
  step(10.0F);
  EXPECT_EQ(node.target, -200);
}

}  // namespace
}  // namespace breakaway::test
