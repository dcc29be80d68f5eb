#include "breakaway/evaluation/record_csv.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "../refusal.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::evaluation {
namespace {

const RecordUnits units{.period_s = 1e-3, .resolution_m = 1e-6, .force_step_N = 0.025, .axis = "x"};

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(record_of_csv(text, units));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(RecordCsv, GivesBackWhatItWrote) {
  Record record{1e-3, 1e-6, 0.025, {}};
  for (int i = 0; i < 50; ++i) record.readings.push_back({1e-6 * i * i, 0.025 * i, i % 7 != 3});
  const Record again = record_of_csv(to_csv(record), units);
  ASSERT_EQ(again.readings.size(), record.readings.size());
  for (std::size_t i = 0; i < record.readings.size(); ++i) {
    EXPECT_EQ(again.readings[i].fresh, record.readings[i].fresh) << i;
    if (!record.readings[i].fresh) continue;
    EXPECT_DOUBLE_EQ(again.readings[i].position_m, record.readings[i].position_m);
    EXPECT_DOUBLE_EQ(again.readings[i].command_N, record.readings[i].command_N);
  }
}

// At the end of what 32 bits count, in counts that are no power of ten.
TEST(RecordCsv, IsExactToTheCountFarFromZero) {
  constexpr double count_m = 7e-7;
  Record record{1e-3, count_m, 0.025, {}};
  for (int i = 0; i < 50; ++i) record.readings.push_back({count_m * (2147483647 - i), 0, true});
  const Record again = record_of_csv(to_csv(record), {1e-3, count_m, 0.025, 50, "x"});
  ASSERT_EQ(again.readings.size(), record.readings.size());
  for (std::size_t i = 0; i < record.readings.size(); ++i)
    EXPECT_NEAR(again.readings[i].position_m, record.readings[i].position_m, 0.01 * count_m) << i;
}

TEST(RecordCsv, TakesItsColumnsWhereverTheyStandAndOneAxisOfSeveral) {
  const Record record = record_of_csv(
      "mode,command_N,time_s,axis,position_m\r\nhold,1.5,7.000,x,0.25\r\nhold,9,7.000,y,1\r\nhold,2,7.001,x,0.5\r\n",
      units);
  ASSERT_EQ(record.readings.size(), 2U);
  EXPECT_EQ(record.readings[1].position_m, 0.5);
  EXPECT_EQ(record.readings[1].command_N, 2);
}

TEST(RecordCsv, RefusesTwoRunsAndNamesTheLineWhereTheSecondBegins) {
  const std::string two_runs = "time_s,position_m,command_N\n1,5,0\n1.001,5,0\n1.002,5,0\n900,6,0\n";
  EXPECT_NE(refusal(two_runs).find("line 5: time_s jumps by 899 s"), std::string::npos) << refusal(two_runs);
  EXPECT_NE(refusal(two_runs).find("give one run"), std::string::npos);
  const Record record = record_of_csv("time_s,position_m,command_N\n1,5,0\n1.001,5,0\n2.001,6,0\n", units);
  EXPECT_EQ(record.readings.size(), 1002U) << "a gap of a thousand periods is filled up";
}

// Lines that are a period apart, but for a share of them that is lost.
std::string lines_at(double period_s, int share_lost_of_ten = 0) {
  std::string text = "time_s,position_m,command_N\n";
  for (int i = 0; i < 300; ++i)
    if (i * 7 % 10 >= share_lost_of_ten) text += std::to_string(i * period_s) + ",0,0\n";
  return text;
}

TEST(RecordCsv, RefusesARecordOfAnotherPeriodThanTheFileHas) {
  for (const double period_s : {1e-4, 0.5e-3, 0.97e-3, 1.03e-3, 1.4e-3, 2e-3, 1.0}) {
    const std::string said = refusal(lines_at(period_s));
    EXPECT_NE(said.find("s apart and [loop] period_s is 0.001: set period_s to"), std::string::npos) << said;
  }
  EXPECT_NE(refusal(lines_at(0.5e-3)).find("the lines are 0.0005 s apart"), std::string::npos);
}

TEST(RecordCsv, TakesARecordWhoseClockIsOffByLittleOrWhoseSamplesWereLost) {
  EXPECT_EQ(refusal(lines_at(0.99e-3)), "");
  EXPECT_EQ(refusal(lines_at(1.01e-3)), "");
  EXPECT_EQ(refusal(lines_at(1e-3, 3)), "");
  RecordUnits fast = units;
  fast.period_s = 1.0 / 64000;
  EXPECT_EQ(record_of_csv(lines_at(fast.period_s), fast).readings.size(), 300U) << "times are whole microseconds";
}

TEST(RecordCsv, TakesAByteOrderMarkBlanksAndPlusSigns) {
  const Record record =
      record_of_csv("\xEF\xBB\xBFtime_s, position_m ,command_N\n+0, +1 ,\t2\n0.001 ,-1,+2e-3\t\r\n", units);
  ASSERT_EQ(record.readings.size(), 2U);
  EXPECT_EQ(record.readings[0].position_m, 1);
  EXPECT_EQ(record.readings[0].command_N, 2);
  EXPECT_EQ(record.readings[1].position_m, -1);
  EXPECT_EQ(record.readings[1].command_N, 2e-3);
}

TEST(RecordCsv, RefusesWhatIsMoreThanANumber) {
  const auto said = [](const std::string& row) { return refusal("time_s,position_m,command_N\n" + row + "\n"); };
  EXPECT_NE(said("0.001s,-0.4,12").find("line 2: column 1 is not a number alone"), std::string::npos);
  EXPECT_NE(said("0.001,-0.4 m,12").find("line 2: column 2 is not a number alone"), std::string::npos);
  EXPECT_NE(said("0.001,-0.4,12N").find("line 2: column 3 is not a number alone"), std::string::npos);
  for (const char* field : {"+-1", "++1", "1 2", "nan", "inf", "", "+"})
    EXPECT_NE(said("0," + std::string{field} + ",0").find("line 2: column 2"), std::string::npos) << field;
}

TEST(RecordCsv, RefusesAPositionThatNoEncoderOf32BitsReads) {
  const auto said = [](const std::string& position_m) {
    return refusal("time_s,position_m,command_N\n0," + position_m + ",0\n");
  };
  EXPECT_EQ(said("-4294.9"), "");
  EXPECT_NE(said("-4295").find("line 2: column 2 is -4295 m"), std::string::npos) << said("-4295");
  EXPECT_NE(said("1e300").find("check [drive] encoder_resolution_m"), std::string::npos) << said("1e300");
}

TEST(RecordCsv, RefusesAForceThatNoDriveGave) {
  RecordUnits limited = units;
  limited.max_force_N = 50;
  const auto said = [&](const std::string& command_N) {
    return testing::refusal(
        [&] { static_cast<void>(record_of_csv("time_s,position_m,command_N\n0,0," + command_N + "\n", limited)); });
  };
  EXPECT_EQ(said("-50"), "");
  EXPECT_NE(said("45000").find("line 2: column 3 is 4.5e+04 N, and the [drive] gives 50 N at most"), std::string::npos)
      << said("45000");
}

TEST(RecordCsv, RefusesAColumnThatIsThereTwice) {
  const std::string said = refusal("time_s,position_m,position_m,command_N\n0,0,0,0\n");
  EXPECT_NE(said.find("more than one column position_m"), std::string::npos) << said;
}

TEST(RecordCsv, SaysWhichAxesThereAreWhereTheWantedOneIsNotAmongThem) {
  const std::string said = refusal("time_s,position_m,command_N,axis\n0,0,0,a\n0,0,0,b\n0.001,0,0,a\n");
  EXPECT_NE(said.find("no line has x in its column axis, which names a, b:"), std::string::npos) << said;
}

TEST(RecordCsv, NamesEightOfTheAxesThatThereAre) {
  std::string text = "time_s,position_m,command_N,axis\n";
  for (char axis = 'a'; axis < 'm'; ++axis) text += std::string{"0,0,0,"} + axis + "\n";
  const std::string said = refusal(text);
  EXPECT_NE(said.find("which names a, b, c, d, e, f, g, h:"), std::string::npos) << said;
  const std::string control = refusal("time_s,position_m,command_N,axis\n0,0,0,a\rb\n");
  EXPECT_NE(control.find("names a?b:"), std::string::npos) << control;
}

TEST(RecordCsv, PassesOverEmptyLines) {
  const Record record = record_of_csv("time_s,position_m,command_N\n0,1,0\n\n0.001,2,0\r\n\r\n\n", units);
  ASSERT_EQ(record.readings.size(), 2U);
  EXPECT_EQ(record.readings.back().position_m, 2);
  EXPECT_TRUE(record.readings.back().fresh);
}

TEST(RecordCsv, NamesTheLineThatIsWrong) {
  EXPECT_NE(
      refusal("time_s,position_m,force_N\n").find("no column command_N: name time_s, position_m and command_N there"),
      std::string::npos);
  EXPECT_NE(refusal("time_s,position_m,command_N\n0,0,0\n0.001,0\n").find("line 3: column 3"), std::string::npos);
  EXPECT_NE(refusal("time_s,position_m,command_N\n0,zero,0\n").find("line 2: column 2"), std::string::npos);
  EXPECT_NE(refusal("time_s,position_m,command_N\n1,0,0\n0.5,0,0\n").find("does not grow"), std::string::npos);
}

}  // namespace
}  // namespace breakaway::evaluation
