/// What one thread of a measurement has, and what all of them share.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

#include "bench/contention/busy_wait.hpp"
#include "bench/contention/histogram.hpp"
#include "bench/contention/scenarios.hpp"
#include "queues/cache_line.hpp"
#include "stress/history/operation.hpp"

namespace irt::contention {

/// Operations of one thread so far. Written by that thread alone, on cache lines of its own; the
/// coordinator looks at it a few times in a whole measurement. All accesses are relaxed: a count
/// informs, it must not order what the queue leaves unordered.
struct alignas(cache_line_pair) Counts {
  std::atomic<std::uint64_t> pushes{0}, pops{0}, failed_pushes{0}, failed_pops{0}, held_back{0};
  std::atomic<std::uint64_t> finished{0};  ///< tasks, of scenarios that have them
};

/// Waits for all threads to arrive, again and again, and tells them alike whether to go on.
class Gate {
 public:
  explicit Gate(unsigned threads) : threads_(threads) {}

  /// False once `stop` was set when the last thread arrived, or the gate was abandoned.
  bool pass(const std::atomic<bool>& stop) {
    const unsigned round = round_.load(std::memory_order_relaxed);
    // (1) acq_rel: pairs with itself, so that the last to arrive has seen what all others did
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
      arrived_.store(0, std::memory_order_relaxed);
      ended_ = stop.load(std::memory_order_relaxed);
      // (2) release: pairs with (3)
      round_.store(round + 1, std::memory_order_release);
    } else {
      constexpr int patience = 1000;
      // (3) acquire: pairs with (2), for `ended_`, `arrived_` and what others did before the gate
      for (int spins = 0; round_.load(std::memory_order_acquire) == round; ++spins) {
        if (abandoned_.load(std::memory_order_relaxed)) return false;
        if (spins > patience) std::this_thread::yield();
      }
    }
    return !ended_;
  }

  /// One thread will not come any more: nobody waits for it.
  void abandon() { abandoned_.store(true, std::memory_order_relaxed); }

 private:
  unsigned threads_;
  alignas(cache_line_pair) std::atomic<unsigned> arrived_{0};
  alignas(cache_line_pair) std::atomic<unsigned> round_{0};
  std::atomic<bool> abandoned_{false};
  bool ended_ = false;
};

/// What all threads of a measurement share.
struct Table {
  explicit Table(Roles of) : roles(of), counts(of.workers), gate(of.workers) {}

  /// Elements in the queue, by all threads' counts.
  [[gnu::always_inline, nodiscard]] std::uint64_t inside() const {
    std::uint64_t pushes = 0, pops = 0;
    for (const Counts& one : counts) {
      pops += one.pops.load(std::memory_order_relaxed);
      pushes += one.pushes.load(std::memory_order_relaxed);
    }
    return pushes > pops ? pushes - pops : 0;
  }

  /// Tasks that are done, by all threads' counts.
  [[nodiscard]] std::uint64_t finished() const {
    std::uint64_t sum = 0;
    for (const Counts& one : counts) sum += one.finished.load(std::memory_order_relaxed);
    return sum;
  }

  Roles roles;
  std::vector<Counts> counts;  ///< by thread
  std::size_t backlog = 0;     ///< elements inside beyond which producers wait for consumers
  std::uint64_t pause_steps = 0;
  Gate gate;
  alignas(cache_line_pair) std::atomic<bool> stop{false};
};

/// One thread. `worker` is its number, and its worker in the queue.
struct Seat {
  Seat(Table& shared, unsigned number, const Waits& between, std::uint64_t seed)
      : table(shared), worker(number), waits(between), random(seed) {}

  Table& table;
  unsigned worker;
  Waits waits;  ///< between operations
  SplitMix random;
  std::uint64_t producer_pause_steps = 0;
  Histogram push_times, pop_times;  ///< ticks; of operations that succeeded
  std::uint64_t in = 0, out = 0;    ///< sums of the elements pushed and popped
  /// Every operation that succeeded, where `log_room` is not 0; the measurement ends when a thread
  /// has made so many.
  std::vector<stress::Operation> log;
  std::size_t log_room = 0;
};

}  // namespace irt::contention
