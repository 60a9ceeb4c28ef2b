#include "renderer/engine/task_counts.hpp"

#include <gtest/gtest.h>

namespace irt {
namespace {

TEST(TaskCounts, NoTaskIsLeftWhenAllThatWereMadeAreDone) {
  TaskCounts counts(3);
  counts.open(2);
  for (unsigned thread = 0; thread < 3; ++thread) counts.rest(thread, true);
  unsigned watched = 1;
  EXPECT_FALSE(counts.all_done(watched));
  counts.count(0, 2, true);
  counts.count(1, 0, true);
  EXPECT_EQ(counts.outstanding(), 2U);
  counts.count(2, 0, true);
  EXPECT_FALSE(counts.all_done(watched));
  counts.count(0, 0, true);
  EXPECT_TRUE(counts.all_done(watched));
}

TEST(TaskCounts, WhoDoesNotRestIsWatched) {
  TaskCounts counts(3);
  counts.open(0);
  counts.rest(0, true);
  counts.rest(1, true);
  unsigned watched = 0;
  EXPECT_FALSE(counts.all_done(watched)) << "although nothing is left";
  EXPECT_EQ(watched, 2U);
  EXPECT_FALSE(counts.all_rest());
  counts.rest(2, true);
  EXPECT_TRUE(counts.all_rest());
  EXPECT_TRUE(counts.all_done(watched));
}

TEST(TaskCounts, ATaskThatComesOutTwiceIsDoneOnce) {
  TaskCounts counts(1);
  counts.open(1);
  counts.count(0, 0, true);
  counts.count(0, 0, false);
  EXPECT_EQ(counts.outstanding(), 0U);
  counts.count(0, 1, false);
  EXPECT_EQ(counts.outstanding(), 1U) << "what it led to is";
}

TEST(TaskCounts, AFrameStartsAnew) {
  TaskCounts counts(2);
  counts.open(1);
  counts.count(1, 0, true);
  counts.rest(0, true);
  counts.open(5);
  EXPECT_EQ(counts.outstanding(), 5U);
  EXPECT_FALSE(counts.all_rest());
}

}  // namespace
}  // namespace irt
