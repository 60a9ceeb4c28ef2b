/// CC-Synch: threads hand their requests to the one of them that happens to be first in a list, the
/// combiner, which serves them one after the other (Fatourou and Kallimanis 2012, "Revisiting the
/// Combining Synchronization Technique", PPoPP).
///
/// When to use: many cores want the same small thing done to the same data. The data stays in the
/// combiner's cache, where a lock would move it to the next core each time, and a request costs
/// about what handing a lock over costs. When not: more threads than cores. While the combiner has
/// none, nobody's request is served. It works on time of its own for up to as many others as there
/// are workers, so that it is more likely to lose its core there than the holder of a lock. And who
/// loses its core between the two steps of making a request hides all that were made after it. (Who
/// loses it while it waits holds up nobody, unless it is to be the next combiner.)
///
/// Order: first come, first served. Progress: blocking. Memory: four lines for each worker and four
/// more, preallocated.
///
/// How it works: the list ends in a node that has no request yet. Who makes one exchanges this last
/// node for its own fresh one, writes the request into the node it got, links the fresh one behind
/// it and waits at its node, until that says either that the request was served, or that it is for
/// the waiting thread to serve. In the second case it serves all requests that are linked, from its
/// own on, and then tells the next node's owner, present or future, to serve. Each keeps the node
/// that it has waited at for its next request.
///
/// What differs from the paper, and why:
/// - What a node says is one word with three values, where the paper has two flags: one store for a
///   request that was served.
/// - What is private to a thread there belongs to a worker here.
/// - `h`, how many requests a combiner serves at most, is the number of workers, so that it serves
///   all that wait when it begins. More would save few hand-overs, and keep it from its own work
///   for longer.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "queues/blocking/spin_until.hpp"
#include "queues/cache_line.hpp"

namespace irt {

template <class Request>
class CcSynch {
 public:
  explicit CcSynch(unsigned workers) : most_served_(workers), nodes_(workers + 1), own_(workers) {
    for (unsigned worker = 0; worker < workers; ++worker) own_[worker].node = &nodes_[worker];
    // relaxed, twice: construction is single-threaded
    nodes_[workers].says.store(Says::serve, std::memory_order_relaxed);
    last_.store(&nodes_[workers], std::memory_order_relaxed);
  }

  /// Returns `request` after `serve(request)`, which may run in another worker's call: all calls'
  /// `serve` must do the same and must not throw. Blocking.
  template <class Serve>
  Request run(unsigned worker, Request request, Serve serve) {
    Node* fresh = own_[worker].node;
    // relaxed, twice: (1) and (2) publish the node
    fresh->next.store(nullptr, std::memory_order_relaxed);
    fresh->says.store(Says::wait, std::memory_order_relaxed);
    // (1) acq_rel: pairs with this very line of cc_synch.hpp in the request before, whose fresh
    // node is ours now
    Node* mine = last_.exchange(fresh, std::memory_order_acq_rel);
    mine->request = request;
    // (2) release: pairs with (4), so that the combiner sees the request, and the fresh node whole
    mine->next.store(fresh, std::memory_order_release);
    own_[worker].node = mine;
    Says says = Says::wait;
    spin_until_zero([&] {
      // (3) acquire: pairs with (5) to see the answer, with (6) to see what was served before
      says = mine->says.load(std::memory_order_acquire);
      return says == Says::wait;
    });
    if (says == Says::serve) combine(*mine, serve);
    return mine->request;
  }

 private:
  enum class Says : std::uint8_t { wait, served, serve };

  struct alignas(cache_line_pair) Node {
    Request request{};
    std::atomic<Node*> next{nullptr};
    std::atomic<Says> says{Says::wait};
  };

  struct alignas(cache_line_pair) Own {
    Node* node = nullptr;
  };

  // Serves the request of `first` and those behind it.
  template <class Serve>
  void combine(Node& first, Serve serve) {
    Node* node = &first;
    for (unsigned left = most_served_; left > 0; --left) {
      // (4) acquire: pairs with (2)
      Node* next = node->next.load(std::memory_order_acquire);
      if (next == nullptr) break;
      serve(node->request);
      // (5) release: pairs with (3). From here on the node is its owner's
      node->says.store(Says::served, std::memory_order_release);
      node = next;
    }
    // (6) release: pairs with (3)
    node->says.store(Says::serve, std::memory_order_release);
  }

  const unsigned most_served_;
  std::vector<Node> nodes_;
  std::vector<Own> own_;
  alignas(cache_line_pair) std::atomic<Node*> last_;
};

}  // namespace irt
