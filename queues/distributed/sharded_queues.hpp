/// SHARDS: a queue for every few workers, of any kind, and who finds his own empty searches the
/// others. So do Linux' unbound workqueues since 7.1 (WQ_AFFN_CACHE_SHARD: shards of up to 8 cores
/// that share a cache).
///
/// When to use: one queue for all has become the bottleneck, and what a shard shares it should go
/// on sharing: workers of a shard need not search, and a task stays near who made it. As the least
/// that a distribution of one's own has to beat. When not: up to 8 workers, for then it is the
/// queue inside; the oldest task of all must leave first.
///
/// Ordering: FIFO for each producer, whose tasks all go through one shard. *Empty* speaks of one
/// shard after the other. Progress: that of the queue inside. Memory: that of as many queues, each
/// made for all workers: with hazard pointers, workers times shards slots and lists. Unbounded.
///
/// How it works: workers whose numbers follow each other make a shard, all shards being of nearly
/// one size. Renderer and benchmarks bind workers to cores in the order of their numbers, so that
/// these are neighbours. A worker pushes to its own shard. It pops from there, or else from the
/// first that has something of those after it, and round.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/blocking/mutex_queue.hpp"
#include "queues/cache_line.hpp"
#include "queues/lock_free/michael_scott_queue.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// `Inner<T>`, an unbounded FIFO queue, for up to `most` workers each.
template <class T, template <class> class Inner, unsigned most = 8>
class Sharded {
  static constexpr Claims inner = Inner<T>::claims;
  static_assert(inner.many_to_many() && !inner.bounded && !HasLeave<Inner<T>>,
                "a shard is pushed to by all of its workers, popped from by all there are, never "
                "full, and left by nobody");
  static_assert(inner.ordering == Ordering::fifo_real_time ||
                    inner.ordering == Ordering::fifo_happens_before,
                "a producer's order and *empty* are claimed as those of FIFO shards");

 public:
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .push = inner.push,
                                 .pop = inner.pop,
                                 .reclamation = inner.reclamation,
                                 .elements = inner.elements};

  Sharded(unsigned workers, std::size_t capacity) {
    const unsigned count = (workers + most - 1) / most;
    each_ = (workers + count - 1) / count;
    for (unsigned i = 0; i < count; ++i)
      shards_.push_back(std::make_unique<Shard>(workers, capacity / count));
  }

  /// Adds `task` at the back of the worker's shard. Progress: that of the queue inside. Always
  /// true.
  bool push(unsigned worker, T task) {
    return shards_[worker / each_]->queue.push(worker, std::move(task));
  }

  /// Takes the oldest task of the worker's shard, or of another; false if each was empty when it
  /// was looked at. Progress: that of the queue inside.
  bool pop(unsigned worker, T& task) {
    std::size_t shard = worker / each_;
    for (std::size_t i = 0; i < shards_.size(); ++i) {
      if (shards_[shard]->queue.pop(worker, task)) return true;
      if (++shard == shards_.size()) shard = 0;
    }
    return false;
  }

 private:
  struct alignas(cache_line_pair) Shard {
    Shard(unsigned workers, std::size_t capacity) : queue(workers, capacity) {}
    Inner<T> queue;
  };

  unsigned each_;
  std::vector<std::unique_ptr<Shard>> shards_;
};

template <class T>
class MutexShards : public Sharded<T, MutexQueue> {
 public:
  static constexpr std::string_view summary =
      "a deque under a mutex for every 8 workers, who search the others";
  using Sharded<T, MutexQueue>::Sharded;
};

template <class T>
class LfreeShards : public Sharded<T, MichaelScottQueue> {
 public:
  static constexpr std::string_view summary = "LFREE for every 8 workers, who search the others";
  using Sharded<T, MichaelScottQueue>::Sharded;
};

}  // namespace irt
