// The runs of a study as a table: what shards write, and what is merged from them.
#include "breakaway/study/study_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "../scratch_folder.hpp"
#include "breakaway/format/output_file.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::study {
namespace {

class StudyTable : public breakaway::testing::ScratchFolder {
 protected:
  std::string written(const std::string& name, const std::vector<StudyRow>& rows) {
    format::write_output(path(name), study_table_parts(rows, "# a"));
    return path(name);
  }
  std::string refused(const std::vector<std::string>& paths, const StudyOptions& options,
                      const std::string& label = "# a") {
    return breakaway::testing::refusal([&] { merged_study(paths, label, options); });
  }
};

std::string table_of(const std::vector<StudyRow>& rows) {
  std::string all;
  const auto next = study_table_parts(rows, "# a");
  for (std::string part = next(); !part.empty(); part = next()) all += part;
  return all;
}

// Numbers of every kind, under laws that a study of one random law has.
std::vector<StudyRow> odd_rows() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), none = std::numeric_limits<double>::infinity();
  StudyRun settled{.place = 0,
                   .law = "constant at the lower bound",
                   .settled = true,
                   .settling_time_s = 0.1 + 0.2,
                   .final_error_m = -1.0 / 3e6,
                   .excursions = {5e-324, 1.7976931348623157e308, 3, -0.4, 1e-9},
                   .max_force_N = 200,
                   .kicks = 7,
                   .reached = {{1e-3, 0.25}, {1e-6, nan}},
                   .faults = {}};
  StudyRun failed = settled;
  failed.settled = false;
  failed.limit_cycle = true;
  failed.settling_time_s = nan;
  failed.excursions.lowest_m = none;
  failed.excursions.highest_m = -none;
  failed.reached.clear();
  failed.faults = {{0.25, "axis jammed"}, {0.5, "less force, than commanded"}};
  StudyRow row{{-0.4, -0.0}, {}};
  for (std::size_t place = 0; place < 5; ++place) {
    row.runs.push_back(place % 2 == 0 ? settled : failed);
    row.runs.back().place = place;
    row.runs.back().law = law_name({.starts = {}, .random_laws = 1, .seed = 9, .threads = 0, .progress = {}}, place);
  }
  return {row};
}

StudyOptions options_of_odd_rows() {
  return {.starts = {{-0.4, -0.0}}, .random_laws = 1, .seed = 9, .threads = 0, .progress = {}};
}

TEST_F(StudyTable, IsReadBackBitForBit) {
  const std::vector<StudyRow> rows = odd_rows();
  const auto read = merged_study({written("t.csv", rows)}, "# a", options_of_odd_rows());
  EXPECT_EQ(table_of(read), table_of(rows));
  ASSERT_EQ(read.size(), 1U);
  const StudyRun& failed = read[0].runs[3];
  EXPECT_TRUE(std::isnan(failed.settling_time_s));
  EXPECT_EQ(failed.excursions.lowest_m, std::numeric_limits<double>::infinity());
  ASSERT_EQ(failed.faults.size(), 2U);
  EXPECT_EQ(failed.faults[1].name, "less force, than commanded");
  EXPECT_EQ(failed.faults[1].time_s, 0.5);
  EXPECT_TRUE(failed.limit_cycle);
  EXPECT_EQ(read[0].runs[0].settling_time_s, 0.1 + 0.2);
  EXPECT_EQ(read[0].runs[0].reached.size(), 2U);
  EXPECT_EQ(read[0].runs[4].law, "random, seed 9");
}

TEST_F(StudyTable, OfShardsIsThatOfTheWholeStudy) {
  const auto scene = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/braked_axis.toml");
  StudyOptions options{.starts = {{-0.1, 0}, {-0.01, 0}}, .random_laws = 5, .seed = 3, .threads = 1, .progress = {}};
  const std::string whole = table_of(run_study(scene, options));
  for (const int count : {2, 9}) {
    std::vector<std::string> parts;
    std::size_t runs = 0;
    for (int index = 1; index <= count; ++index) {
      options.shard = {index, count};
      const auto rows = run_study(scene, options);
      for (const StudyRow& row : rows) {
        EXPECT_FALSE(row.runs.empty());
        runs += row.runs.size();
      }
      parts.push_back(written(std::to_string(index) + ".csv", rows));
    }
    std::ranges::reverse(parts);
    EXPECT_EQ(runs, 18U);
    options.shard = {};
    EXPECT_EQ(table_of(merged_study(parts, "# a", options)), whole) << count;
  }
  options.shard = {1, 10};
  EXPECT_NE(breakaway::testing::refusal([&] { run_study(scene, options); }).find("there are 9 laws"),
            std::string::npos);
}

TEST_F(StudyTable, RefusesWhatIsMissingDoubledOtherwiseOrOfAnotherStudy) {
  const std::vector<StudyRow> rows = odd_rows();
  const StudyOptions options = options_of_odd_rows();
  const std::string whole = written("whole.csv", rows);
  EXPECT_EQ(refused({whole, whole}, options), "") << "the same twice is no contradiction";
  std::vector<StudyRow> changed = rows;
  changed[0].runs.resize(4);
  EXPECT_NE(refused({written("few.csv", changed)}, options).find("1 of 5 runs are in none of the files"),
            std::string::npos);
  changed = rows;
  changed[0].runs[2].kicks += 1;
  EXPECT_NE(refused({whole, written("other.csv", changed)}, options).find("other.csv:5: contradicts"),
            std::string::npos);
  EXPECT_NE(refused({whole}, options, "# b").find("whole.csv:1: is not \"# b\""), std::string::npos);
  StudyOptions elsewhere = options;
  elsewhere.starts[0].position_m = -0.5;
  EXPECT_NE(refused({whole}, elsewhere).find("whole.csv:3: begins where this study does not"), std::string::npos);
  StudyOptions fewer = options;
  fewer.random_laws = 0;
  EXPECT_NE(refused({whole}, fewer).find("whole.csv:7: is of a law that this study does not have"), std::string::npos);
  EXPECT_NE(refused({path("none.csv")}, options).find("none.csv: cannot be read"), std::string::npos);
  const std::string text = table_of(rows);
  const auto refused_text = [&](const std::string& spoilt) {
    format::write_output(path("spoilt.csv"), spoilt);
    return refused({path("spoilt.csv")}, options);
  };
  EXPECT_NE(refused_text("").find("is no table of a study"), std::string::npos);
  EXPECT_NE(refused_text(text.substr(0, text.size() - 1)).find("spoilt.csv:7: is not whole"), std::string::npos);
  EXPECT_NE(refused_text(text + "\n").find("spoilt.csv:8: is no run of the form"), std::string::npos);
  for (const char* line : {"-0.4,-0,0,2,0,", "-0.4,-0,0,1,0,0.3", "-0.4,-0,0,1,0,+1,"})
    EXPECT_NE(refused_text(text + line + "\n").find("is no run of the form"), std::string::npos) << line;
}

// Whatever is changed is refused, or is one number for another: what was read is then what stands there.
TEST_F(StudyTable, SpoiltAnywhereIsRefusedOrReadAsItStands) {
  const std::string text = table_of(odd_rows());
  std::mt19937 random{7};  // NOLINT: the same bytes every time
  int refusals = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string spoilt = text;
    const std::size_t at = random() % spoilt.size();
    spoilt[at] = static_cast<char>(random() % 256);
    if (random() % 4 == 0) spoilt.erase(random() % spoilt.size(), 1 + random() % 40);
    format::write_output(path("spoilt.csv"), spoilt);
    std::vector<StudyRow> read;
    const std::string said =
        breakaway::testing::refusal([&] { read = merged_study({path("spoilt.csv")}, "# a", options_of_odd_rows()); });
    refusals += !said.empty();
    if (!said.empty()) continue;
    EXPECT_EQ(table_of(read), spoilt);
  }
  EXPECT_GT(refusals, 600);
}

TEST(StudyTableLabel, DiffersWithFileAxisLawsAndSeed) {
  const StudyOptions options = options_of_odd_rows();
  StudyOptions more = options, seeded = options;
  more.random_laws = 2;
  seeded.seed = 10;
  const std::string label = study_table_label("text", "x", options);
  EXPECT_EQ(label.front(), '#');
  EXPECT_EQ(study_table_label("text", "x", options), label);
  EXPECT_NE(study_table_label("texu", "x", options), label);
  EXPECT_NE(study_table_label("text", "y", options), label);
  EXPECT_NE(study_table_label("textx", "", options), label);
  EXPECT_NE(study_table_label("text", "x", more), label);
  EXPECT_NE(study_table_label("text", "x", seeded), label);
}

}  // namespace
}  // namespace breakaway::study
