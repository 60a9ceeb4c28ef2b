// Runs little programs of equal threads given as data.

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <type_traits>

#include "queues/work_queue.hpp"
#include "tests/stress/checker/twins.hpp"

namespace {

using namespace irt::twins;

struct Block {
  std::atomic<int> word{0};
  int plain = 0;
};

std::atomic<int> words[variables];
struct alignas(8) Slot : std::atomic<int> {
  using std::atomic<int>::atomic;
};
Slot slots[max_threads];
std::atomic<Block*> published;
std::mutex mutex;
int guarded;

/// What a thread carries from step to step.
struct State {
  int thread;
  int last = 0;
  bool stops = false;
};

void run(const Step& step, State& state) {
  std::atomic<int>& v = words[step.variable];
  const auto order = static_cast<std::memory_order>(step.order);
  const auto odd = [&] { return state.thread == step.thread && state.last == step.seen; };
  switch (step.kind) {
    case load:
      state.last = v.load(order);
      return;
    case store:
      return v.store(step.value, order);
    case exchange:
      state.last = v.exchange(step.value, order);
      return;
    case add:
      state.last = v.fetch_add(step.value, order);
      return;
    case fence:
      return std::atomic_thread_fence(order);
    case compare:
      state.last = 0;
      v.compare_exchange_strong(state.last, step.value, order, std::memory_order_relaxed);
      return;
    case store_number:
      return v.store(state.thread + 1, order);
    case swap_number:
      state.last = v.exchange(state.thread + 1, order);
      return;
    case slot_store:
      return slots[state.thread].store(step.value, order);
    case slot_load:
      if (state.last >= 1 && state.last <= static_cast<int>(max_threads))
        state.last = slots[state.last - 1].load(order);
      return;
    case publish: {
      auto* block = new Block;
      block->plain = step.value;
      block->word.store(step.value, std::memory_order_relaxed);
      // The one that was there is kept, for others may follow it.
      Block* old = published.load(std::memory_order_relaxed);
      if (!published.compare_exchange_strong(old, block, std::memory_order_acq_rel)) delete block;
      return;
    }
    case follow: {
      Block* block = published.load(std::memory_order_acquire);
      if (block != nullptr) state.last = block->plain + block->word.exchange(step.value, order);
      return;
    }
    case locked_add: {
      const std::lock_guard lock(mutex);
      state.last = guarded;
      guarded += step.value;
      return;
    }
    case await:
      while ((state.last = v.load(order)) == 0) {
      }
      return;
    case odd_one:
      return v.store(odd() ? step.value + 50 : step.value, order);
    case odd_slot:
      return slots[(static_cast<unsigned>(state.thread) + (state.thread == step.thread ? 1U : 0U)) %
                   max_threads]
          .store(step.value, order);
    case scan:
      for (Slot& slot : slots) state.last += slot.load(order);
      return;
    case last_one_stops:
      state.stops = odd();
      return;
  }
}

}  // namespace

namespace {

/// What makes one worker of a queue another one.
enum class Fault {
  none,
  third_worker,  ///< the pushes of worker 2 are lost
  rare_worker,   ///< a pop of worker 1 that finds an element of worker 2 forgets to take it
  order_of_scan  ///< none, but workers tell by the order in which they count who comes first
};

/// A list under one lock, with a count for each worker.
template <class T, Fault fault>
class Counted {
 public:
  static constexpr std::string_view summary = "a list under one lock that counts";
  static constexpr irt::Claims claims{.ordering = irt::Ordering::fifo_real_time, .max_workers = 8};

  Counted(unsigned, std::size_t) {}

  bool push(unsigned worker, T task) {
    const std::lock_guard lock(mutex_);
    ++counts_[worker];
    if (fault == Fault::third_worker && worker == 2) return true;
    tasks_[last_++] = task;
    return true;
  }
  bool pop(unsigned worker, T& task) {
    const std::lock_guard lock(mutex_);
    if (fault == Fault::order_of_scan)
      for (const long& count : counts_)
        if (count > 1000) return false;
    if (first_ == last_) return false;
    task = tasks_[first_];
    bool forgets = false;
    if constexpr (std::is_integral_v<T>)
      forgets = fault == Fault::rare_worker && worker == 1 && task / 100 == 3;
    if (!forgets) ++first_;
    return true;
  }

 private:
  std::mutex mutex_;
  T tasks_[16] = {};
  long first_ = 0;
  long last_ = 0;
  long counts_[8] = {};
};

template <class T>
using Even = Counted<T, Fault::none>;
template <class T>
using ThirdWorker = Counted<T, Fault::third_worker>;
template <class T>
using RareWorker = Counted<T, Fault::rare_worker>;
template <class T>
using OrderOfScan = Counted<T, Fault::order_of_scan>;

constexpr irt::QueueEntry entries[] = {
    irt::queue_entry<Even>("even"),
    irt::queue_entry<ThirdWorker>("third-worker"),
    irt::queue_entry<RareWorker>("rare-worker"),
    irt::queue_entry<OrderOfScan>("order-of-scan"),
};

}  // namespace

extern "C" const irt::QueueEntry* irt_probe_entries(unsigned* count) {
  *count = sizeof entries / sizeof *entries;
  return entries;
}

// The program's own claim: no thread ends having read `forbidden` last.
extern "C" void irt_twins_run(const Step* steps, unsigned count, int thread, int forbidden) {
  State state{thread};
  for (unsigned i = 0; i < count && !state.stops; ++i) run(steps[i], state);
  if (state.last == forbidden) std::abort();
}

// What comes after the threads: all words are looked at and, if so asked, the slot of thread 0.
extern "C" int irt_twins_end(bool first_slot) {
  int sum = 0;
  for (const std::atomic<int>& word : words) sum += word.load(std::memory_order_relaxed);
  return first_slot ? sum + slots[0].load(std::memory_order_relaxed) : sum;
}
