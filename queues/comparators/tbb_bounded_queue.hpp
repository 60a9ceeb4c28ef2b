/// oneTBB's `concurrent_bounded_queue`.
///
/// When to use: as `TbbQueue`, where memory must have a bound. When not: threads wait for each
/// other often, for a thread that pushes or pops may have to wake sleepers.
///
/// Ordering: what the library documents, FIFO for each producer. Progress: blocking. Memory: pages
/// of the library's cache-aligned allocator. Bounded.
///
/// How it works: the lists of pages of `TbbQueue`; tickets are given out only while they are less
/// than the capacity apart. The waiting forms of push and pop sleep on monitors; the others look
/// whether anybody sleeps.
///
/// `TbbWaitingQueue` waits as the library does, and is closed by pills: words that are pushed until
/// nobody waits any more, and that every pop throws away. The library's `abort` would not do. It
/// gives back the ticket of whoever waits, also of one whose element has just come in; the next two
/// pops then have one ticket, and one of them spins for ever (scenario *parked-closed-early*). Each
/// push pays for the closing a full barrier that `TbbBoundedQueue` does not.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <oneapi/tbb/concurrent_queue.h>
#include <string_view>
#include <thread>

#include "queues/blocking/closing.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class TbbBoundedQueue {
 public:
  static constexpr std::string_view summary = "oneTBB concurrent_bounded_queue";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .bounded = true,
                                 .reclamation = Reclamation::library};

  TbbBoundedQueue(unsigned /*workers*/, std::size_t capacity) {
    queue_.set_capacity(static_cast<std::ptrdiff_t>(capacity));
  }

  /// Adds `task`; false if the queue is full. Blocking.
  bool push(unsigned /*worker*/, T task) { return queue_.try_push(task); }

  /// Takes a task; false if it sees none. Blocking.
  bool pop(unsigned /*worker*/, T& task) { return queue_.try_pop(task); }

 private:
  tbb::concurrent_bounded_queue<T> queue_;
};

template <class T>
class TbbWaitingQueue {
 public:
  static constexpr std::string_view summary = "oneTBB concurrent_bounded_queue, its waiting pop";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .bounded = true,
                                 .reclamation = Reclamation::library,
                                 .all_ones_reserved = true};

  TbbWaitingQueue(unsigned workers, std::size_t capacity) : closing_(workers) {
    queue_.set_capacity(static_cast<std::ptrdiff_t>(capacity));
  }

  /// Adds `task`; false if the queue is full or closed. Blocking.
  bool push(unsigned worker, T task) {
    return closing_.push(worker, [&] { return queue_.try_push(task); });
  }

  /// Takes a task; false if it sees none. Blocking.
  bool pop(unsigned /*worker*/, T& task) {
    for (T found; queue_.try_pop(found);)
      if (keep(found, task)) return true;
    return false;
  }

  /// Takes a task, waiting for one; false once the queue is closed and nothing is inside.
  bool pop_wait(unsigned worker, T& task) {
    waiting_.fetch_add(1);
    bool kept = false;
    while (!kept && !closing_.closed()) {
      T found;
      queue_.pop(found);
      kept = keep(found, task);
    }
    waiting_.fetch_sub(1);
    if (kept) return true;
    closing_.wait_for_pushes();
    return pop(worker, task);
  }

  /// Refuses what is pushed from now on, and wakes whoever waits. Blocking: until they have heard.
  void close() {
    closing_.close();
    // seq_cst, as the additions: who begins to wait after this look sees the queue closed
    while (waiting_.load() != 0) {
      queue_.try_push(element_of<T>(pill));
      std::this_thread::yield();
    }
  }

 private:
  static constexpr std::uint64_t pill = ~std::uint64_t{0};

  static bool keep(const T& found, T& task) {
    if (word_of(found) == pill) return false;
    task = found;
    return true;
  }

  tbb::concurrent_bounded_queue<T> queue_;
  Closing closing_;
  std::atomic<unsigned> waiting_{0};
};

}  // namespace irt
