#include "breakaway/watch/history.hpp"

#include <gtest/gtest.h>

#include <string>

namespace {

using breakaway::watch::Excerpt;
using breakaway::watch::History;
using breakaway::watch::Sample;

Sample at(double time_s, const std::string& axis = "") { return {.axis = axis, .time_s = time_s, .position_m = 0}; }

TEST(WatchHistory, GivesWhatFollowsInOrder) {
  History history;
  for (int n = 0; n < 5; ++n) history.add(at(n));
  const Excerpt first = history.read(0, 3);
  ASSERT_EQ(first.samples.size(), 3U);
  EXPECT_EQ(first.samples[2].time_s, 2);
  EXPECT_EQ(first.next, 3U);
  EXPECT_TRUE(first.more);
  const Excerpt rest = history.read(first.next, 3);
  ASSERT_EQ(rest.samples.size(), 2U);
  EXPECT_EQ(rest.samples[0].time_s, 3);
  EXPECT_FALSE(rest.more);
  EXPECT_TRUE(history.read(rest.next, 3).samples.empty());
  EXPECT_TRUE(history.read(1'000'000, 3).samples.empty());
  EXPECT_EQ(history.read(1'000'000, 3).next, 5U) << "whoever asks too far finds back";
}

TEST(WatchHistory, ForgetsTheOldest) {
  History history{3};
  for (int n = 0; n < 5; ++n) history.add(at(n));
  const Excerpt kept = history.read(0, 10);
  ASSERT_EQ(kept.samples.size(), 3U);
  EXPECT_EQ(kept.samples[0].time_s, 2);
  EXPECT_EQ(kept.next, 5U);
}

TEST(WatchHistory, NamesTheAxesAsTheyCome) {
  History history;
  for (const char* name : {"y", "x", "y"}) history.add(at(0, name));
  EXPECT_EQ(history.read(0, 9).axes, (std::vector<std::string>{"y", "x"}));
}

TEST(WatchHistory, NamesThatSomebodyInventsDoNotFillTheMemory) {
  History history;
  for (int n = 0; n < 1000; ++n) history.add(at(n, std::to_string(n)));
  const Excerpt all = history.read(0, 2000);
  EXPECT_EQ(all.axes.size(), History::most_axes);
  EXPECT_EQ(all.samples.size(), History::most_axes);
  EXPECT_EQ(all.losses.malformed, 1000 - History::most_axes);
}

TEST(WatchHistory, CountsWhatWasLostAndKeepsTheNewestComplaint) {
  History history;
  EXPECT_TRUE(history.losses().complaint.empty());
  history.complain("first");
  history.complain("second");
  history.add_lost_on_the_way(3);
  history.add_lost_on_the_way(4);
  history.set_lost_at_sender(9);
  const auto losses = history.losses();
  EXPECT_EQ(losses.malformed, 2U);
  EXPECT_EQ(losses.complaint, "second");
  EXPECT_EQ(losses.on_the_way, 7U);
  EXPECT_EQ(losses.at_sender, 9U);
}

}  // namespace
