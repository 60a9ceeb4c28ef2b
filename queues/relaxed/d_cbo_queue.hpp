/// d-CBO: several FIFO queues beside each other, whose pushes and pops are counted; an operation
/// looks at the counts of d = 2 of them at random and takes the lower (von Geijer, Tsigas,
/// Johansson and Hermansson 2025, "Balanced Allocations over Efficient Queues: A Fast Relaxed FIFO
/// Queue", PPoPP).
///
/// When to use: many cores push and pop at once, an order that holds on average is enough, and
/// *empty* must be true. When not: a bound on the order must hold in every case; threads poll a
/// queue that is mostly empty, for each *empty* asks every queue inside; memory is short, see
/// below.
///
/// Ordering: none that is certain. With n queues inside, an element leaves before no more than in
/// the order of n log log n older ones with high probability (so the paper, of certain executions),
/// however many are inside. A call that is stopped before it has counted adds to that. *Empty* is
/// exact, by happens-before. Progress: that of the queues inside, here lock-free apart from the
/// allocator. Memory: that of twice as many queues as workers; each has hazard pointers of its own,
/// whose room for retired nodes grows with the square of the number of workers. Unbounded.
///
/// How it works: a push counts when its element is inside, a pop when it has taken one. If pushes
/// are balanced by their count and pops by theirs, the i-th push of a queue inside is about the
/// (i n)-th of all, and so is its i-th pop. A pop that finds its choice empty asks all queues in
/// turn, and notes before each how many pushes that has counted. If none has counted more when all
/// are found empty, all were empty at the moment between; a push that has not counted yet is no
/// part of that, and has not returned. (Double collect: Afek, Attiya, Dolev, Gafni, Merritt and
/// Shavit 1993.)
///
/// What differs from the paper, and why:
/// - The counts are those of its "simple" variant, kept beside the queues. What queues count
///   themselves saves an instruction, but each would have to show it, and some count what others
///   do not (a pop that finds nothing, a place that was spoilt).
/// - The number of queues is fixed by that of workers, which the paper leaves to be tuned.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/lock_free/lcrq.hpp"
#include "queues/lock_free/michael_scott_queue.hpp"
#include "queues/split_mix.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The algorithm, over queues of the kind of `Inner`.
template <template <class> class Inner>
struct DCbo {
  template <class T>
  class Queue {
   public:
    static constexpr Claims claims{.ordering = Ordering::unordered,
                                   .push = Inner<T>::claims.push,
                                   .pop = Inner<T>::claims.pop,
                                   .empty = Answer::exact,
                                   .reclamation = Inner<T>::claims.reclamation,
                                   .needs_cas2 = Inner<T>::claims.needs_cas2,
                                   .elements = Inner<T>::claims.elements};
    static_assert((Inner<T>::claims.ordering == Ordering::fifo_happens_before ||
                   Inner<T>::claims.ordering == Ordering::fifo_real_time) &&
                      Inner<T>::claims.many_to_many() && !Inner<T>::claims.bounded,
                  "the queues inside must be unbounded FIFO queues for any number of workers");

    /// The queues inside share `capacity`.
    Queue(unsigned workers, std::size_t capacity) : workers_(workers) {
      const std::size_t count = std::size_t{queues_for_each_worker} * workers;
      for (unsigned worker = 0; worker < workers; ++worker) {
        workers_[worker].random = SplitMix(worker);
        workers_[worker].pushed.resize(count);
      }
      for (std::size_t i = 0; i < count; ++i)
        parts_.emplace_back(workers, (capacity + count - 1) / count);
    }

    /// Adds `task` to a queue of few pushes. Lock-free. Always true.
    bool push(unsigned worker, T task) {
      Part& part = parts_[lower_of_two(worker, &Part::pushed)];
      part.queue.push(worker, std::move(task));
      // (1) release: pairs with (2), so that who has counted this push finds its task
      part.pushed.fetch_add(1, std::memory_order_release);
      return true;
    }

    /// Takes the oldest task of a queue of few pops, or of any; false if there is none. Lock-free:
    /// looks at all of them again only if a push has returned meanwhile.
    bool pop(unsigned worker, T& task) {
      std::size_t first = lower_of_two(worker, &Part::popped);
      if (take(worker, first, task)) return true;
      std::vector<std::uint64_t>& pushed = workers_[worker].pushed;
      for (;;) {
        for (std::size_t i = 0; i < parts_.size(); ++i) {
          const std::size_t at = (first + i) % parts_.size();
          // (2) acquire: pairs with (1)
          pushed[at] = parts_[at].pushed.load(std::memory_order_acquire);
          if (take(worker, at, task)) return true;
        }
        // relaxed: what was pushed before somebody took what this pop has missed is in the count,
        // for the pops of the queues inside have handed that on
        std::size_t i = 0;
        while (i < parts_.size() && pushed[i] == parts_[i].pushed.load(std::memory_order_relaxed))
          ++i;
        if (i == parts_.size()) return false;
        first = i;
      }
    }

   private:
    static constexpr unsigned queues_for_each_worker = 2;

    struct Part {
      Part(unsigned workers, std::size_t capacity) : queue(workers, capacity) {}

      ByWorker<Inner<T>, T> queue;
      alignas(cache_line_pair) std::atomic<std::uint64_t> pushed{0};
      alignas(cache_line_pair) std::atomic<std::uint64_t> popped{0};
    };

    struct alignas(cache_line_pair) Worker {
      SplitMix random{0};
      std::vector<std::uint64_t> pushed;  // what its pop has counted
    };

    // One of two queues at random, the one with the lower `count`.
    std::size_t lower_of_two(unsigned worker, std::atomic<std::uint64_t> Part::*count) {
      SplitMix& random = workers_[worker].random;
      const std::size_t a = random.below(parts_.size());
      const std::size_t b = random.below(parts_.size());
      // relaxed, twice: an old count makes a worse choice
      return (parts_[b].*count).load(std::memory_order_relaxed) <
                     (parts_[a].*count).load(std::memory_order_relaxed)
                 ? b
                 : a;
    }

    bool take(unsigned worker, std::size_t at, T& task) {
      Part& part = parts_[at];
      if (!part.queue.pop(worker, task)) return false;
      part.popped.fetch_add(1, std::memory_order_relaxed);  // relaxed: for choices only
      return true;
    }

    std::vector<Worker> workers_;
    std::deque<Part> parts_;
  };
};

template <class T>
class DCboQueue : public DCbo<MichaelScottQueue>::Queue<T> {
 public:
  static constexpr std::string_view summary = "d-CBO: the less used of two queues, over LFREE";
  using DCbo<MichaelScottQueue>::Queue<T>::Queue;
};

/// Its queues have rings of `capacity` in all, or of 4,096 places each.
template <class T>
class DCboLcrq : public DCbo<Lcrq>::Queue<T> {
 public:
  static constexpr std::string_view summary = "d-CBO: the less used of two queues, over LCRQ";
  using DCbo<Lcrq>::Queue<T>::Queue;
};

}  // namespace irt
