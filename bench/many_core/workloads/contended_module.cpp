// Compiled for virtual cores. Each object lies on lines of its own.
#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

#include "bench/many_core/workloads/contended.hpp"
#include "queues/cache_line.hpp"

#if __has_include(<atomic_queue/atomic_queue.h>)
#include <atomic_queue/atomic_queue.h>
#define IRT_ATOMIC_QUEUE
#endif

namespace irt::many_core {
namespace {

struct alignas(cache_line_pair) Counter {
  std::atomic<std::uint64_t> count{0};
};

struct alignas(cache_line_pair) Value {
  std::uint64_t value = 0;
};

struct Remembered {
  explicit Remembered(unsigned threads) : seen(threads) {}
  Counter count;
  std::vector<Value> seen;
};

struct Private {
  explicit Private(unsigned threads) : counters(threads) {}
  std::vector<Counter> counters;
};

struct alignas(cache_line_pair) Neighbours {
  std::array<std::atomic<std::uint64_t>, 8> counts{};
};

struct alignas(cache_line_pair) Guarded {
  std::mutex mutex;
  std::uint64_t count = 0;
};

struct Ticket {
  alignas(cache_line_pair) std::atomic<std::uint64_t> next{0};
  alignas(cache_line_pair) std::atomic<std::uint64_t> serving{0};
  std::uint64_t count = 0;
};

void fetch_and_add(void* object, unsigned) {
  // relaxed: a counter
  static_cast<Counter*>(object)->count.fetch_add(1, std::memory_order_relaxed);
}

void compare_and_swap(void* object, unsigned thread) {
  auto& [count, seen] = *static_cast<Remembered*>(object);
  // relaxed: a counter
  while (!count.count.compare_exchange_weak(seen[thread].value, seen[thread].value + 1,
                                            std::memory_order_relaxed)) {
  }
  ++seen[thread].value;
}

void load_and_swap(void* object, unsigned) {
  auto& count = static_cast<Counter*>(object)->count;
  // relaxed: a counter
  std::uint64_t seen = count.load(std::memory_order_relaxed);
  while (!count.compare_exchange_weak(seen, seen + 1, std::memory_order_relaxed)) {
  }
}

void private_add(void* object, unsigned thread) {
  // relaxed: a counter
  static_cast<Private*>(object)->counters[thread].count.fetch_add(1, std::memory_order_relaxed);
}

void neighbour_add(void* object, unsigned thread) {
  // relaxed: a counter
  static_cast<Neighbours*>(object)->counts[thread % 8].fetch_add(1, std::memory_order_relaxed);
}

void guarded_add(void* object, unsigned) {
  auto& guarded = *static_cast<Guarded*>(object);
  const std::lock_guard lock(guarded.mutex);
  ++guarded.count;
}

void ticket_add(void* object, unsigned) {
  auto& lock = *static_cast<Ticket*>(object);
  // relaxed: the order comes from `serving`
  const std::uint64_t mine = lock.next.fetch_add(1, std::memory_order_relaxed);
  // (1) acquire: pairs with (2), so that counting happens one after the other
  while (lock.serving.load(std::memory_order_acquire) != mine) {
  }
  ++lock.count;
  // (2) release: pairs with (1)
  lock.serving.store(mine + 1, std::memory_order_release);
}

#ifdef IRT_ATOMIC_QUEUE
// What their author measures with: push and pop that take a ticket by fetch-and-add and wait for
// its slot. They are no plug-in, for a pop from an empty queue never ends.
using WordRing = atomic_queue::AtomicQueue<unsigned, 65536>;
using StateRing = atomic_queue::AtomicQueue2<unsigned, 65536>;

template <class Ring>
void push_or_pop(void* object, unsigned thread) {
  auto& ring = *static_cast<Ring*>(object);
  if (thread % 2 == 0) {
    ring.push(1);
  } else {
    ring.pop();
  }
}
#endif

template <class T>
void* make_one(unsigned) {
  return new T;
}
template <class T>
void* make_for(unsigned threads) {
  return new T(threads);
}

constexpr std::array all{
    Contended{"faa", "fetch-and-add on one line", make_one<Counter>, fetch_and_add},
    Contended{"cas", "compare-and-swap loop on one line", make_for<Remembered>, compare_and_swap},
    Contended{"load-cas", "the same, with a load first", make_one<Counter>, load_and_swap},
    Contended{"private", "fetch-and-add, a line each", make_for<Private>, private_add},
    Contended{"neighbours", "fetch-and-add, a word each on one line", make_one<Neighbours>,
              neighbour_add},
    Contended{"mutex-counter", "std::mutex around a counter", make_one<Guarded>, guarded_add},
    Contended{"ticket-lock", "ticket lock around a counter", make_one<Ticket>, ticket_add},
#ifdef IRT_ATOMIC_QUEUE
    Contended{"optimist-ring", "atomic_queue's OptimistAtomicQueue, every other thread pushes",
              make_one<WordRing>, push_or_pop<WordRing>, true},
    Contended{"optimist-ring-2", "the same of OptimistAtomicQueue2", make_one<StateRing>,
              push_or_pop<StateRing>, true},
#endif
};

}  // namespace
}  // namespace irt::many_core

void irt_contended(std::span<const irt::many_core::Contended>& all) {
  all = irt::many_core::all;
}
