/// SPLIT: iRT's own way to hand out work: a split deque for each worker, and who has nothing left
/// steals half of what the nearest shares.
///
/// When to use: in the renderer, and wherever tasks make tasks. While all have work a worker
/// touches nothing that others touch, as with LOCAL; once one has none it helps, as with stealing.
/// When not: one worker pushes what all the others pop, for then every pop is a theft; the oldest
/// task must leave first; a task that is alone with a worker which does not come back must be seen
/// by others.
///
/// Ordering: none. *Empty* speaks for this worker: a single task of another may be unseen.
/// Progress: `push` is wait-free, apart from the allocator, `pop` lock-free. Memory: an array of 8
/// bytes per place for each worker, which grows and is kept; see split_deque.hpp. Unbounded.
///
/// How it works: a worker pushes to its own deque and pops from there; split_deque.hpp says what of
/// it others see. A thief goes round all others, nearest first (victims.hpp), and brings half of
/// what it finds shared to its own deque, of which it shares again: so work spreads as fast as it
/// doubles, and first within a cache.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/distributed/split_deque.hpp"
#include "queues/distributed/victims.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class SplitQueues {
 public:
  static constexpr std::string_view summary =
      "SPLIT, iRT's own: half-private deques, half stolen, nearest first";
  static constexpr Claims claims{.push = Progress::wait_free,
                                 .pop = Progress::lock_free,
                                 .empty = Answer::this_worker,
                                 .reclamation = Reclamation::free_list};

  /// Each deque begins with its part of `capacity`.
  SplitQueues(unsigned workers, std::size_t capacity) {
    workers_.reserve(workers);
    for (unsigned worker = 0; worker < workers; ++worker)
      workers_.push_back(std::make_unique<Worker>(worker, workers, capacity / workers));
  }

  /// Adds `task` to the worker's own deque. Wait-free. Always true.
  bool push(unsigned worker, T task) {
    workers_[worker]->deque.push(word_of(task));
    return true;
  }

  /// Takes one of the worker's own tasks or the oldest that another shares; false if it sees none.
  /// Lock-free.
  bool pop(unsigned worker, T& task) {
    std::uint64_t word = 0;
    Worker& me = *workers_[worker];
    if (!me.deque.take(word) && !steal(me, word)) return false;
    task = element_of<T>(word);
    return true;
  }

 private:
  struct alignas(cache_line_pair) Worker {
    Worker(unsigned worker, unsigned workers, std::size_t capacity)
        : victims(worker, workers), deque(std::min(capacity, most_at_first)) {}

    NearestVictims victims;
    SplitDeque deque;
  };

  static constexpr std::size_t most_at_first = 1024;  // places of a deque

  bool steal(Worker& me, std::uint64_t& word) {
    for (;;) {
      bool lost = false;
      const bool found = me.victims.find([&](unsigned victim) {
        const Theft theft = workers_[victim]->deque.steal(word, me.deque);
        lost |= theft == Theft::lost;
        return theft == Theft::taken;
      });
      if (found || !lost) return found;
    }
  }

  std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace irt
