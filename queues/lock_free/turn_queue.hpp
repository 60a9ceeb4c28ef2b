/// CRTurn: a wait-free list whose nodes are linked and handed out in turns (Correia and Ramalhete
/// 2017, "A Wait-Free Queue with Wait-Free Memory Reclamation", PPoPP), with hazard pointers.
///
/// When to use: no thread may be kept from its task by others, however unlucky it is. When not:
/// throughput is what counts, for each operation may look at every worker's request; there are many
/// workers, for the same reason.
///
/// Ordering: FIFO in real time. Progress: wait-free, apart from the allocator: an operation makes
/// at most two rounds more than there are workers. Memory: one node per task, from the allocator;
/// each worker keeps the last one it popped; nodes that have left wait for hazard pointers, see
/// there for the bound. Unbounded.
///
/// How it works: a linked list behind a sentinel, as Michael and Scott's. A worker that pushes
/// offers its node, and in each round everybody who pushes links the node of one and the same
/// worker behind the last one: the next that offers one, counted from the worker whose node is
/// last. So an offer waits for at most one node of each other worker. Pops do the same at the other
/// end: who wants a node says so, and everybody who pops hands the first node to the next such
/// worker, counted from the one that had the sentinel. A node names its popper, once for all; it is
/// then written where that worker looks for it, and becomes the sentinel.
///
/// A pop that finds nothing takes its request back. Somebody may have seen it and found a node
/// meanwhile, so it looks at the list once more, and if there is a node hands it to whoever's turn
/// it is, or else to itself. Then that node is gone, and who saw the request too late cannot give
/// it away.
///
/// What differs from the paper, and why:
/// - A request is open while `asked_` equals `given_`, as in the paper. Here it is taken back by a
///   null pointer, where the paper restores the value before, for which a worker must keep two
///   nodes and not one.
/// - Rounds are not counted. A worker repeats them until it is served; that this comes true in time
///   is the paper's theorem, and nothing would break if it did not.
/// - The last look of a pop in vain is a round as any other, for every round makes sure that its
///   worker is not served yet after it has protected the first node, not before.
/// - A node's hazard pointer and the look that confirms it are one step, `try_protect`; there is no
///   `protect` here, which is only lock-free.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/reclamation/hazard_pointers.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class TurnQueue {
 public:
  static constexpr std::string_view summary =
      "CRTurn: wait-free list, requests served in turn, hazard pointers";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  /// Nodes are reclaimed in batches no larger than `capacity`, as in michael_scott_queue.hpp.
  TurnQueue(unsigned workers, std::size_t capacity)
      : workers_(workers),
        hazards_(workers, std::min<std::size_t>(capacity, std::max(64U, 4 * workers))),
        offered_(workers),
        asked_(workers),
        given_(workers) {
    // relaxed: construction is single-threaded
    for (std::atomic<Node*>& given : given_) given.store(&first_, std::memory_order_relaxed);
  }
  TurnQueue(const TurnQueue&) = delete;
  TurnQueue& operator=(const TurnQueue&) = delete;

  ~TurnQueue() {
    // relaxed, three times: destruction is single-threaded. The sentinel is in `given_`
    Node* node = head_.load(std::memory_order_relaxed)->next.load(std::memory_order_relaxed);
    while (node != nullptr) delete std::exchange(node, node->next.load(std::memory_order_relaxed));
    for (std::atomic<Node*>& given : given_)
      if (given.load(std::memory_order_relaxed) != &first_)
        delete given.load(std::memory_order_relaxed);
  }

  /// Adds `task` at the back. Wait-free. Always true.
  bool push(unsigned worker, T task) {
    Node* node = new Node{std::move(task), worker};
    // (1) seq_cst: pairs with (4). For who links the node a release would do; but it is served in
    // so many rounds only if whoever sees a later tail than this worker sees the offer as well
    offered_[worker].store(node, std::memory_order_seq_cst);
    // (2) acquire: pairs with (3), so that who sees this push returned does not find an older tail
    while (offered_[worker].load(std::memory_order_acquire) == node) link(worker);
    return true;
  }

  /// Takes the oldest task; false if there is none. Wait-free.
  bool pop(unsigned worker, T& task) {
    // relaxed: what this worker was given last it has read before
    Node* const old = given_[worker].load(std::memory_order_relaxed);
    // (7) seq_cst: pairs with (10), for the same reason as in push()
    asked_[worker].store(old, std::memory_order_seq_cst);
    Node* node = nullptr;
    // (8) acquire: pairs with (12), so that the task is read as written
    while ((node = given_[worker].load(std::memory_order_acquire)) == old) {
      if (hand_out(worker, old)) continue;
      // (9) seq_cst: pairs with (10) and (11). Who still saw the request had seen before that there
      // is a node, and so this worker sees it in the next line
      asked_[worker].store(nullptr, std::memory_order_seq_cst);
      hand_out(worker, old);
      // relaxed: (8) reads it again
      if (given_[worker].load(std::memory_order_relaxed) == old) return false;
    }
    // Who gave it may not have moved `head_` yet, which must have left `old` before it is retired.
    // relaxed, twice: as in hand_out(); and the node is known, so that it is only compared
    Node* first = head_.load(std::memory_order_relaxed);
    if (hazards_.guard(worker).template try_protect<at_first>(first, head_, first) &&
        first->next.load(std::memory_order_relaxed) == node)
      move(head_, first, node);
    task = std::move(node->task);
    if (old != &first_) hazards_.guard(worker).retire(old);
    return true;
  }

 private:
  enum Slot : std::size_t { at_first, at_next, at_given, at_last = at_first };

  static constexpr unsigned nobody = ~0U;

  struct Node {
    T task{};
    unsigned pusher = 0;
    std::atomic<unsigned> popper{nobody};
    std::atomic<Node*> next{nullptr};
  };

  // The first worker after `last` for whom `wants` is true; `nobody` if there is none.
  template <class Wants>
  unsigned next_in_turn(unsigned last, Wants wants) const {
    for (unsigned i = 1; i <= workers_; ++i)
      if (const unsigned worker = (last + i) % workers_; wants(worker)) return worker;
    return nobody;
  }

  // A round of pushing: sees to it that a node is behind the one that is last now, if one is
  // offered.
  void link(unsigned worker) {
    // relaxed: a guess that try_protect() confirms
    Node* last = tail_.load(std::memory_order_relaxed);
    if (!hazards_.guard(worker).template try_protect<at_last>(last, tail_, last)) return;
    // It is in the list, and must not be offered any more when another one is linked behind it.
    // relaxed: (3) confirms it
    std::atomic<Node*>& offered = offered_[last->pusher];
    Node* offer = offered.load(std::memory_order_relaxed);
    // (3) release: pairs with (2). relaxed on failure: another thread has done it
    if (offer == last)
      offered.compare_exchange_strong(offer, nullptr, std::memory_order_release,
                                      std::memory_order_relaxed);
    Node* node = nullptr;
    next_in_turn(last->pusher, [&](unsigned other) {
      // (4) seq_cst: pairs with (1)
      node = offered_[other].load(std::memory_order_seq_cst);
      return node != nullptr;
    });
    if (node == nullptr) return;
    Node* next = nullptr;
    // (5) release: pairs with (6)
    // (6) acquire: on failure; pairs with (5), so that a node we move `tail_` to is whole for who
    // reads it there
    if (last->next.compare_exchange_strong(next, node, std::memory_order_release,
                                           std::memory_order_acquire))
      next = node;
    move(tail_, last, next);
  }

  // A round of popping: sees to it that the first node goes to somebody, unless `worker`, which had
  // `old`, has been served. False if there is none.
  bool hand_out(unsigned worker, const Node* old) {
    // relaxed: a guess that try_protect() confirms
    Node* first = head_.load(std::memory_order_relaxed);
    if (!hazards_.guard(worker).template try_protect<at_first>(first, head_, first)) return true;
    // relaxed: what was given before `first` became the first is seen, which is all that matters
    if (given_[worker].load(std::memory_order_relaxed) != old) return true;
    // (11) seq_cst: pairs with (9), together with the load in popper_of()
    if (tail_.load(std::memory_order_seq_cst) == first) return false;
    // relaxed: (11) has acquired what follows `first`, for (13) is a release of it
    Node* next = first->next.load(std::memory_order_relaxed);
    if (!hazards_.guard(worker).template try_protect<at_next>(next, head_, first)) return true;
    give(worker, popper_of(next, first, worker), next, first);
    move(head_, first, next);
    return true;
  }

  // Who gets `node`, which follows `first`: whoever's turn it is, or else `worker`.
  unsigned popper_of(Node* node, const Node* first, unsigned worker) {
    // relaxed: who moved `head_` to `first` knew its popper
    const unsigned last = first->popper.load(std::memory_order_relaxed);
    unsigned popper = next_in_turn(last, [&](unsigned other) {
      // (10) seq_cst: pairs with (7) and (9). relaxed for what was given: what was given before
      // `first` became the first is seen, and where it was given later `node` has its popper
      return asked_[other].load(std::memory_order_seq_cst) ==
             given_[other].load(std::memory_order_relaxed);
    });
    if (popper == nobody) popper = worker;
    unsigned before = nobody;
    // relaxed: it is decided here, whatever is seen elsewhere
    return node->popper.compare_exchange_strong(before, popper, std::memory_order_relaxed) ? popper
                                                                                           : before;
  }

  // `popper` finds `node` in `given_`, unless it is not behind `first` any more.
  void give(unsigned worker, unsigned popper, Node* node, const Node* first) {
    // (14) acquire: pairs with (12), so that where it was given later than `node`, try_protect()
    // finds `head_` moved. While that is at `first` the popper cannot have retired `old`, which is
    // therefore the same node until (12)
    Node* old = given_[popper].load(std::memory_order_acquire);
    if (old != node && (popper == worker ||
                        hazards_.guard(worker).template try_protect<at_given>(old, head_, first)))
      // (12) release: pairs with (8) and (14). relaxed on failure: another thread has done it
      given_[popper].compare_exchange_strong(old, node, std::memory_order_release,
                                             std::memory_order_relaxed);
  }

  static void move(std::atomic<Node*>& source, Node* from, Node* to) {
    // (13) release: pairs with the load in try_protect() of hazard_pointers.hpp, so that `to` is
    // whole for who reads it there; and with the fence there, which is what retire() asks for.
    // relaxed on failure: another thread has done it
    source.compare_exchange_strong(from, to, std::memory_order_release, std::memory_order_relaxed);
  }

  const unsigned workers_;
  HazardPointers<Node, 3> hazards_;
  Node first_;  // the first sentinel, which everybody has popped and nobody retires
  std::vector<std::atomic<Node*>> offered_;  // a node to be linked, by pusher
  std::vector<std::atomic<Node*>> asked_;    // the same as in `given_`: a node is wanted
  std::vector<std::atomic<Node*>> given_;    // the last node that was popped, by popper
  alignas(cache_line_pair) std::atomic<Node*> head_{&first_};
  alignas(cache_line_pair) std::atomic<Node*> tail_{&first_};
};

}  // namespace irt
