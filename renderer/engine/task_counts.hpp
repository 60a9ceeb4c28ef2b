/// Knows when a frame has no task left, without a word that all threads write.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace irt {

/// Each thread counts for itself the tasks that it has made and those that it has done, on a cache
/// line that others read only when nobody seems to have work. Who adds up first what all have done
/// and then what all have made, and finds as many, has seen the end. For whatever is in the first
/// sum is in the second: a task was counted as made before it was queued. And a task that was made
/// and is not done is in the second alone; or, if its making was not seen, so is one that led to
/// it, back to those that the frame started with. (The idea of counting on both sides is Mattern's,
/// "Algorithms for distributed termination detection", Distributed Computing 1987.)
///
/// A thread that finds nothing says that it rests, and watches one that does not: that flag changes
/// rarely, so a look costs those who work nothing.
class TaskCounts {
 public:
  explicit TaskCounts(unsigned threads) : threads_(threads) {}

  /// Opens a frame that starts with so many tasks. While no thread works; a barrier publishes it.
  void open(std::size_t tasks) {
    // Relaxed, all: no thread works.
    for (OfThread& thread : threads_) {
      thread.made.store(0, std::memory_order_relaxed);
      thread.done.store(0, std::memory_order_relaxed);
      thread.rests.store(false, std::memory_order_relaxed);
    }
    threads_.front().made.store(tasks, std::memory_order_relaxed);
  }

  /// `thread` has worked on a task that led to so many more, and queues these afterwards. Who was
  /// not the first to take it has not done it.
  void count(unsigned thread, std::size_t children, bool first_time) {
    OfThread& mine = threads_[thread];
    // Relaxed, both loads: this thread's own.
    if (children != 0)
      mine.made.store(mine.made.load(std::memory_order_relaxed) + children,
                      std::memory_order_relaxed);
    // (1) release: pairs with (2), so that who counts this task as done counts its children as
    // made, and, since the queue has ordered its push before, the task itself.
    if (first_time)
      mine.done.store(mine.done.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Whether `thread` finds nothing.
  void rest(unsigned thread, bool rests) {
    // Relaxed: others look again and again.
    threads_[thread].rests.store(rests, std::memory_order_relaxed);
  }

  /// Whether no task is left, neither queued nor in hand. `watched` is the caller's alone and
  /// starts anywhere below the number of threads.
  [[nodiscard]] bool all_done(unsigned& watched) const {
    for (std::size_t looks = 0; looks < threads_.size(); ++looks) {
      // Relaxed: where it is old, this thread looks once more than needed, or asks the counts.
      if (!threads_[watched].rests.load(std::memory_order_relaxed)) return false;
      watched = watched + 1 == threads_.size() ? 0 : watched + 1;
    }
    return outstanding() == 0;
  }

  /// Whether all rest, as far as is seen.
  [[nodiscard]] bool all_rest() const {
    for (const OfThread& thread : threads_)
      // Relaxed: as in all_done.
      if (!thread.rests.load(std::memory_order_relaxed)) return false;
    return true;
  }

  /// Tasks that are not done: at least as many, and 0 only if there is none.
  [[nodiscard]] std::uint64_t outstanding() const {
    std::uint64_t done = 0, made = 0;
    // (2) acquire: pairs with (1)
    for (const OfThread& thread : threads_) done += thread.done.load(std::memory_order_acquire);
    // Relaxed: what (2) has seen is seen here.
    for (const OfThread& thread : threads_) made += thread.made.load(std::memory_order_relaxed);
    return made - done;
  }

 private:
  struct alignas(128) OfThread {
    std::atomic<std::uint64_t> made{0}, done{0};
    alignas(64) std::atomic<bool> rests{false};
  };
  std::vector<OfThread> threads_;
};

}  // namespace irt
