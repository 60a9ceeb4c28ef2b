/// Nodes of which a test knows whether they have been freed.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <utility>

namespace irt {

struct TestNode {
  std::atomic<int> alive{1};
  std::atomic<TestNode*> next{nullptr};
};

/// What has been freed in the test in hand, and how its memory goes. Not for several threads.
inline std::map<const TestNode*, std::function<void()>>& freed_nodes() {
  static std::map<const TestNode*, std::function<void()>> nodes;
  return nodes;
}

/// Notes what is freed, and keeps its memory until the test is over: no address comes twice.
template <class Node>
class NotedNodes {
 public:
  NotedNodes(unsigned /*workers*/, std::size_t /*batch*/) {}

  template <class... Arguments>
  Node* make(unsigned /*worker*/, Arguments&&... arguments) {
    return new Node{std::forward<Arguments>(arguments)...};
  }
  void free(unsigned /*worker*/, Node* node) {
    EXPECT_TRUE(freed_nodes().emplace(node, [node] { delete node; }).second) << "freed twice";
  }
};

class NotedTest : public testing::Test {
 protected:
  static bool freed(const TestNode* node) { return freed_nodes().contains(node); }
  static std::size_t count_freed() { return freed_nodes().size(); }

  NotedTest() = default;
  // After the reclaimers of the tests that derive from it.
  ~NotedTest() override {
    for (const auto& [node, end] : freed_nodes()) end();
    freed_nodes().clear();
  }
};

}  // namespace irt
