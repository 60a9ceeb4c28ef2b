/// No reclamation: what is retired stays where it is. The control that separates what a queue costs
/// from what giving its memory back costs.
///
/// When to use: in measurements, beside a reclaimer that works. When not: anywhere else; memory
/// grows with every element.
///
/// Progress: wait-free, apart from the allocator. Memory: the structure keeps its nodes reachable
/// and discards them when it is destroyed.
///
/// How it works: the interface of reclaimer.hpp; since no node is ever freed, every node is
/// protected.
#pragma once

#include <atomic>
#include <cstddef>
#include <utility>

#include "queues/reclamation/reclaimer.hpp"

namespace irt {

template <class Node>
class KeepAll {
 public:
  static constexpr Offers offers{.nodes = any_number, .follows_retired = true, .frees = false};

  KeepAll(unsigned workers, std::size_t batch) : nodes_(workers, batch) {}

  class Guard : public ProtectsAll<Node> {
   public:
    /// The node that `source` holds. Wait-free.
    template <std::size_t place>
    Node* protect(const std::atomic<Node*>& source) const {
      // (1) acquire: pairs with the releases that move head and tail in michael_scott_queue.hpp
      return source.load(std::memory_order_acquire);
    }

    /// Nothing. Wait-free.
    void retire(Node* /*node*/) const {}
  };

  [[nodiscard]] Guard guard(unsigned /*worker*/) const { return {}; }

  template <class... Arguments>
  Node* make(unsigned worker, Arguments&&... arguments) {
    return nodes_.make(worker, std::forward<Arguments>(arguments)...);
  }
  void discard(unsigned worker, Node* node) { nodes_.free(worker, node); }

 private:
  HeapNodes<Node> nodes_;
};

}  // namespace irt
