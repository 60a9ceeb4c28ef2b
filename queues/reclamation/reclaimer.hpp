/// What a linked structure and its reclaimer promise each other: the one interface of all headers
/// in this folder.
///
/// A node that was taken out of a structure may still be read by others. A reclaimer knows when
/// that is over, and frees it. It is a class template over the node, and used so:
///
///     Reclaimer<Node> nodes(workers, batch);
///
///     Node* node = nodes.make(worker, arguments...);   // Node{arguments...}
///     const auto guard = nodes.guard(worker);          // one operation of the worker
///     Node* first = guard.template protect<0>(head_);
///     ... guard.template try_protect<1>(next, head_, first) ...
///     guard.retire(first);
///
/// `guard(worker)` is the critical region of an operation: what it protects may be read until it
/// ends, or until the same place protects another node. A worker has one guard at a time. Between
/// its guards it holds no node.
///
/// `protect<place>(source)` returns the node that `source` holds, at least as strong as an acquire
/// load. The structure changes `source` before it retires the node.
///
/// `try_protect<place>(node, source, expected)` protects a node that was read from elsewhere, and
/// says whether `source` still holds `expected`. The structure changes `source` from `expected`
/// before it retires `node`; after `false` the node must not be read. A reclaimer that protects all
/// that a guard can come to answers true without a look.
///
/// `retire(node)` frees a node that nobody can come to any more, once nobody can be reading it. It
/// takes no memory and does not fail. Whatever made the node unreachable must be this thread's own
/// doing, or a release whose effect it has read, be it relaxed. Who retires a node does not read it
/// again.
///
/// `make(worker, arguments...)` may throw std::bad_alloc, and has had no effect then.
/// `discard(worker, node)` gives back a node that nobody else can see.
///
/// `leave(worker)`, where there is one, has to be called by a worker that makes no guard for long.
///
/// Where the memory comes from is a policy of the reclaimer's: `HeapNodes` or `NodeCache`.
///
/// Construction and destruction are single-threaded. What was retired is freed at destruction; what
/// is still in the structure is for the structure to discard.
#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <utility>

namespace irt {

inline constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

/// What a reclaimer has to offer.
struct Offers {
  std::size_t nodes = 0;  ///< that a guard protects at once
  /// What a node leads to may be read although the node itself has been retired meanwhile.
  bool follows_retired = false;
  bool frees = true;  ///< retired nodes; else the structure discards them when it is destroyed
  /// A node may be another one by the time it is read, or a compare-and-swap finds its address.
  bool reuses_at_once = false;
};

/// What a structure asks of its reclaimer.
struct Needs {
  std::size_t nodes = 0;  ///< that an operation reads at once
  /// It goes on from a node to the next without asking whether the first is still inside.
  bool follows_retired = false;
  /// Its pointers carry versions, and what it has read it believes only where those have not
  /// changed.
  bool checks_versions = false;
};

/// Fails to compile where the two do not fit. A structure asserts it, as
/// `static_assert(suits<Reclaimer<Node>::offers, needs>())`.
template <Offers offers, Needs needs>
constexpr bool suits() {
  static_assert(needs.nodes <= offers.nodes,
                "this structure reads more nodes at once than the reclaimer protects: one of them "
                "may be freed while it is read");
  static_assert(!needs.follows_retired || offers.follows_retired,
                "this structure follows the links of nodes that may have been retired, and the "
                "reclaimer protects only what can still be reached: the next node may have been "
                "freed before it was protected");
  static_assert(needs.checks_versions || !offers.reuses_at_once,
                "the reclaimer uses a node again while others read it, and this structure does not "
                "check versions: it would take the new node for the old one (ABA)");
  return true;
}

/// Of a guard that protects whatever its operation can come to.
template <class Node>
struct ProtectsAll {
  /// Always true. Wait-free.
  template <std::size_t place>
  static bool try_protect(Node* /*node*/, const std::atomic<Node*>& /*source*/,
                          const Node* /*expected*/) {
    return true;
  }
};

/// A node from the allocator, and back to it.
///
/// Progress: the allocator's. Memory: nothing beside the nodes. Every tool that watches the
/// allocator sees a node that is freed too early.
template <class Node>
class HeapNodes {
 public:
  HeapNodes(unsigned /*workers*/, std::size_t /*batch*/) {}

  template <class... Arguments>
  Node* make(unsigned /*worker*/, Arguments&&... arguments) {
    return new Node{std::forward<Arguments>(arguments)...};
  }
  void free(unsigned /*worker*/, Node* node) { delete node; }
};

}  // namespace irt
