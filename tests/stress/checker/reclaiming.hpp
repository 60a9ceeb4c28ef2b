/// What a reclaimer has to stand, in a few steps: one thread reads a node, another puts a new one
/// in its place and retires it, a third makes room for both.
///
/// Smaller than any queue, so that the checker sees all of it, and without the queue's own
/// accesses, which may order more than a reclaimer is promised.
#pragma once

#include <array>
#include <atomic>
#include <cstdlib>
#include <thread>
#include <utility>

#include "queues/work_queue.hpp"

namespace irt::reclaiming {

struct Node {
  int value = 0;
  std::atomic<Node*> next{nullptr};
};

enum Worker : unsigned { reader, writer, helper, second_helper };

/// `rounds` operations that retire a node each, which nobody has seen.
template <class Reclaimer>
void churn(Reclaimer& nodes, unsigned worker, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    Node* node = nodes.make(worker, -1);
    const auto guard = nodes.guard(worker);
    guard.retire(node);
  }
}

/// The reader has `reads` operations. The writer unlinks with release order and retires; then it
/// has `idle` operations in which it reads nothing, and `busy` in which it retires something.
/// Helpers have `rounds` of the latter.
template <class Reclaimer>
void one_reader(int reads, int idle, int busy, int helpers, int rounds) {
  Reclaimer nodes(2U + static_cast<unsigned>(helpers), 1);
  std::atomic<Node*> root{nodes.make(writer, 1)};
  std::array<std::thread, 2> helping;
  for (int i = 0; i < helpers; ++i)
    helping.at(static_cast<std::size_t>(i)) = std::thread(
        [&nodes, i, rounds] { churn(nodes, helper + static_cast<unsigned>(i), rounds); });
  std::thread reading([&] {
    for (int i = 0; i < reads; ++i) {
      const auto guard = nodes.guard(reader);
      const Node* node = guard.template protect<0>(root);
      if (node->value <= 0) std::abort();
    }
    leave(nodes, reader);
  });
  Node* fresh = nodes.make(writer, 2);
  {
    const auto guard = nodes.guard(writer);
    guard.retire(root.exchange(fresh, std::memory_order_release));
  }
  for (int i = 0; i < idle; ++i) [[maybe_unused]] const auto guard = nodes.guard(writer);
  churn(nodes, writer, busy);
  reading.join();
  for (int i = 0; i < helpers; ++i) helping.at(static_cast<std::size_t>(i)).join();
  nodes.discard(writer, root.load());
}

/// The reader goes from a node to the next one. The writer makes that after the first, in whatever
/// the reclaimer's time is, links it, and then takes out both, one after the other.
template <class Reclaimer>
void next_node(int before, int busy) {
  Reclaimer nodes(2, 1);
  Node* first = nodes.make(writer, 1);
  std::atomic<Node*> root{first};
  std::thread reading([&] {
    {
      const auto guard = nodes.guard(reader);
      Node* seen = guard.template protect<0>(root);
      Node* next = seen->next.load(std::memory_order_acquire);
      if (next != nullptr && guard.template try_protect<1>(next, root, seen) && next->value <= 0)
        std::abort();
    }
    leave(nodes, reader);
  });
  churn(nodes, writer, before);
  Node* second = nodes.make(writer, 2);
  Node* third = nodes.make(writer, 3);
  first->next.store(second, std::memory_order_release);
  {
    const auto guard = nodes.guard(writer);
    root.store(second, std::memory_order_release);
    guard.retire(first);
  }
  {
    const auto guard = nodes.guard(writer);
    root.store(third, std::memory_order_release);
    guard.retire(second);
  }
  churn(nodes, writer, busy);
  reading.join();
  nodes.discard(writer, third);
}

}  // namespace irt::reclaiming
