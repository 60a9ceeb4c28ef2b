/// Nodes that were retired and are not freed yet, linked through themselves: to retire one takes no
/// memory, and cannot fail.
#pragma once

#include <cstddef>
#include <utility>

namespace irt {

/// `Node` with a link of the reclaimer's. The node's own links are of no use for that: somebody may
/// still follow them.
template <class Node>
struct LinkedNode : Node {
  template <class... Arguments>
  explicit LinkedNode(Arguments&&... arguments) : Node{std::forward<Arguments>(arguments)...} {}

  LinkedNode* below = nullptr;
};

/// A stack of nodes that have a link `below`. One worker's.
template <class Linked>
class Bag {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }

  void add(Linked* node) {
    node->below = top_;
    top_ = node;
    ++size_;
  }

  /// Null when it is empty.
  Linked* take() {
    Linked* node = top_;
    if (node == nullptr) return nullptr;
    top_ = node->below;
    --size_;
    return node;
  }

 private:
  Linked* top_ = nullptr;
  std::size_t size_ = 0;
};

/// Three bags: what was retired since the epoch changed for this worker, since the change before,
/// and since the one before that. One worker's.
template <class Linked>
class Limbo {
 public:
  /// Nodes that were retired since the last change.
  [[nodiscard]] std::size_t fresh() const { return fresh_.size(); }

  void add(Linked* node) { fresh_.add(node); }

  /// The epoch has changed. Returns what has now seen three changes.
  Bag<Linked> change() {
    return std::exchange(old_, std::exchange(recent_, std::exchange(fresh_, {})));
  }

 private:
  Bag<Linked> fresh_;
  Bag<Linked> recent_;
  Bag<Linked> old_;
};

}  // namespace irt
