#include "queues/reclamation/hazard_pointers.hpp"

#include <atomic>
#include <gtest/gtest.h>
#include <set>
#include <thread>
#include <vector>

namespace irt {
namespace {

struct Node {
  std::atomic<int> alive{1};
};

std::set<Node*>& freed() {
  static std::set<Node*> nodes;
  return nodes;
}

/// Notes what is freed and leaves the memory to the test.
struct Note {
  void operator()(Node* node) const { EXPECT_TRUE(freed().insert(node).second) << "freed twice"; }
};

class Hazards : public testing::Test {
 protected:
  void SetUp() override { freed().clear(); }
};

TEST_F(Hazards, frees_what_nobody_protects) {
  HazardPointers<Node, 1, Note> hazards(2, 1);
  Node node;
  hazards.retire(0, &node);
  EXPECT_TRUE(freed().contains(&node));
}

TEST_F(Hazards, keeps_what_somebody_protects_until_the_slot_is_used_again) {
  HazardPointers<Node, 1, Note> hazards(2, 1);
  Node kept;
  Node other;
  Node third;
  std::atomic<Node*> source{&kept};
  EXPECT_EQ(hazards.protect(1, 0, source), &kept);
  source = &other;
  hazards.retire(0, &kept);
  EXPECT_FALSE(freed().contains(&kept));
  EXPECT_EQ(hazards.protect(1, 0, source), &other);
  hazards.retire(0, &third);
  EXPECT_TRUE(freed().contains(&kept));
  EXPECT_TRUE(freed().contains(&third));
}

TEST_F(Hazards, every_slot_of_every_worker_counts) {
  std::vector<Node> nodes(6);
  HazardPointers<Node, 2, Note> hazards(3, 1);
  std::atomic<Node*> source{nullptr};
  for (unsigned i = 0; i < 6; ++i)
    EXPECT_TRUE(hazards.publish(i / 2, i % 2, &nodes[i], source, nullptr));
  for (Node& node : nodes) hazards.retire(1, &node);
  EXPECT_TRUE(freed().empty());
}

TEST_F(Hazards, publish_says_whether_the_source_has_changed) {
  HazardPointers<Node, 1, Note> hazards(1, 1);
  Node node;
  Node other;
  std::atomic<Node*> source{&other};
  EXPECT_FALSE(hazards.publish(0, 0, &node, source, &node));
  EXPECT_TRUE(hazards.publish(0, 0, &node, source, &other));
}

TEST_F(Hazards, holds_back_no_more_than_the_bound) {
  constexpr unsigned workers = 3;
  constexpr unsigned count = 10'000;
  constexpr std::size_t batch = 5;
  std::vector<Node> nodes(count);
  HazardPointers<Node, 2, Note> hazards(workers, batch);
  std::atomic<Node*> source{nullptr};
  for (unsigned i = 0; i < count; ++i) {
    // Now and then somebody protects what is about to be retired, for a while.
    if (i % 7 == 0) hazards.publish(i % workers, i % 2, &nodes[i], source, nullptr);
    hazards.retire(0, &nodes[i]);
    ASSERT_LE(i + 1 - freed().size(), 2 * workers + batch);
  }
}

TEST_F(Hazards, frees_everything_at_destruction) {
  std::vector<Node> nodes(20);
  {
    HazardPointers<Node, 1, Note> hazards(2, 100);
    for (Node& node : nodes) hazards.retire(0, &node);
    EXPECT_TRUE(freed().empty());
  }
  EXPECT_EQ(freed().size(), nodes.size());
}

/// Marks a node dead before its memory goes, so that a reader notices even without a sanitizer.
struct Kill {
  void operator()(Node* node) const {
    node->alive = 0;
    delete node;
  }
};

TEST(HazardThreads, a_protected_node_stays_alive) {
  constexpr unsigned workers = 4;
  std::atomic<Node*> source{new Node};
  std::atomic<bool> done{false};
  std::atomic<int> dead{0};
  {
    HazardPointers<Node, 1, Kill> hazards(workers, 1);
    std::vector<std::thread> threads;
    for (unsigned worker = 1; worker < workers; ++worker)
      threads.emplace_back([&, worker] {
        while (!done) {
          const Node* node = hazards.protect(worker, 0, source);
          for (int look = 0; look < 20; ++look)
            if (node->alive != 1) ++dead;
        }
      });
    for (int i = 0; i < 50'000; ++i) hazards.retire(0, source.exchange(new Node));
    done = true;
    for (std::thread& thread : threads) thread.join();
  }
  delete source.load();
  EXPECT_EQ(dead, 0);
}

}  // namespace
}  // namespace irt
