#include "queues/reclamation/hazard_pointers.hpp"

#include <atomic>
#include <gtest/gtest.h>
#include <vector>

#include "tests/queues/noted_nodes.hpp"

namespace irt {
namespace {

template <std::size_t places>
using Hazards = HazardPointers<TestNode, places, NotedNodes>;

class HazardPointersTest : public NotedTest {};

TEST_F(HazardPointersTest, free_what_nobody_protects) {
  Hazards<1> hazards(2, 1);
  TestNode* node = hazards.make(0);
  hazards.guard(0).retire(node);
  EXPECT_TRUE(freed(node));
}

TEST_F(HazardPointersTest, keep_what_somebody_protects_until_the_place_is_used_again) {
  Hazards<1> hazards(2, 1);
  TestNode* kept = hazards.make(0);
  TestNode* other = hazards.make(0);
  std::atomic<TestNode*> source{kept};
  EXPECT_EQ(hazards.guard(1).protect<0>(source), kept);
  source = other;
  hazards.guard(0).retire(kept);
  EXPECT_FALSE(freed(kept)) << "the guard is over, the hazard pointer is not";
  EXPECT_EQ(hazards.guard(1).protect<0>(source), other);
  hazards.guard(0).retire(hazards.make(0));
  EXPECT_TRUE(freed(kept));
  hazards.discard(0, other);
}

TEST_F(HazardPointersTest, count_in_every_place_of_every_worker) {
  Hazards<2> hazards(3, 1);
  std::vector<TestNode*> nodes(6);
  for (TestNode*& node : nodes) node = hazards.make(0);
  std::atomic<TestNode*> source{nullptr};
  for (unsigned worker = 0; worker < 3; ++worker) {
    const auto guard = hazards.guard(worker);
    EXPECT_TRUE(guard.try_protect<0>(nodes[2 * worker], source, nullptr));
    EXPECT_TRUE(guard.try_protect<1>(nodes[2 * worker + 1], source, nullptr));
  }
  for (TestNode* node : nodes) hazards.guard(1).retire(node);
  EXPECT_EQ(count_freed(), 0U);
}

TEST_F(HazardPointersTest, say_whether_the_source_has_changed) {
  Hazards<1> hazards(1, 1);
  TestNode node;
  TestNode other;
  std::atomic<TestNode*> source{&other};
  EXPECT_FALSE(hazards.guard(0).try_protect<0>(&node, source, &node));
  EXPECT_TRUE(hazards.guard(0).try_protect<0>(&node, source, &other));
}

TEST_F(HazardPointersTest, hold_back_no_more_than_the_bound) {
  constexpr unsigned workers = 3;
  constexpr unsigned count = 10'000;
  constexpr std::size_t batch = 5;
  Hazards<2> hazards(workers, batch);
  std::atomic<TestNode*> source{nullptr};
  for (unsigned i = 0; i < count; ++i) {
    TestNode* node = hazards.make(0);
    // Now and then somebody protects what is about to be retired, for a while.
    if (i % 14 == 0) hazards.guard(i % workers).try_protect<0>(node, source, nullptr);
    if (i % 14 == 7) hazards.guard(i % workers).try_protect<1>(node, source, nullptr);
    hazards.guard(0).retire(node);
    ASSERT_LE(i + 1 - count_freed(), 2 * workers + batch);
  }
}

}  // namespace
}  // namespace irt
