/// No reclamation: what is retired stays where it is. The control that separates what a queue costs
/// from what giving its memory back costs.
///
/// When to use: in measurements, beside a reclaimer that works. When not: anywhere else; memory
/// grows with every element.
///
/// Progress: wait-free. Memory: the structure keeps its nodes reachable and frees them when it is
/// destroyed.
///
/// How it works: the interface of `HazardPointers`; since no node is ever freed, every node is
/// protected.
#pragma once

#include <atomic>
#include <cstddef>

namespace irt {

template <class Node>
class KeepAll {
 public:
  /// What is retired is not freed: the structure does it when it is destroyed.
  static constexpr bool frees = false;

  KeepAll(unsigned /*workers*/, std::size_t /*batch*/) {}

  /// Always true. Wait-free.
  bool publish(unsigned /*worker*/, std::size_t /*slot*/, Node* /*node*/,
               const std::atomic<Node*>& /*source*/, const Node* /*expected*/) {
    return true;
  }

  /// The node that `source` holds. Wait-free.
  Node* protect(unsigned /*worker*/, std::size_t /*slot*/, const std::atomic<Node*>& source) {
    // (1) acquire: pairs with the releases that move head and tail in michael_scott_queue.hpp
    return source.load(std::memory_order_acquire);
  }

  void retire(unsigned /*worker*/, Node* /*node*/) {}
};

}  // namespace irt
