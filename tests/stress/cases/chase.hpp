/// Healthy: two threads that spoil each other's places, which ends with the segment. A push and a
/// pop each draw a ticket by fetch-and-add; a pop that comes first marks its place as spoilt and
/// draws again, and so does the push that finds it. Under an unkind schedule this goes on to the
/// end of the segment (`places` rounds, a few thousand steps), and then the push appends a segment
/// that already has its element. Lock-free by that, and no livelock, however many steps it takes.
/// Real queues have 1,024 places.
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, int places>
class ChaseCase {
 public:
  static constexpr std::string_view summary =
      "segments of places dealt by fetch-and-add, spoilt by an early pop";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::at_destruction};

  ChaseCase(unsigned /*workers*/, std::size_t /*capacity*/) {
    head_.store(first_);
    tail_.store(first_);
  }
  ~ChaseCase() {
    while (first_ != nullptr) {
      Segment* next = first_->next.load();
      delete first_;
      first_ = next;
    }
  }

  bool push(unsigned /*worker*/, T task) {
    for (;;) {
      Segment* last = tail_.load();
      const int at = last->pushes.fetch_add(1);
      if (at < places) {
        last->tasks[at] = task;
        int state = nobody;
        if (last->states[at].compare_exchange_strong(state, here)) return true;
        continue;
      }
      if (last != tail_.load()) continue;
      Segment* next = last->next.load();
      if (next == nullptr) {
        auto* mine = new Segment;
        mine->tasks[0] = task;
        mine->states[0].store(here, std::memory_order_relaxed);
        mine->pushes.store(1, std::memory_order_relaxed);
        if (last->next.compare_exchange_strong(next, mine)) {
          tail_.compare_exchange_strong(last, mine);
          return true;
        }
        delete mine;
      }
      tail_.compare_exchange_strong(last, next);
    }
  }

  bool pop(unsigned /*worker*/, T& task) {
    for (;;) {
      Segment* oldest = head_.load();
      if (oldest->pops.load() >= oldest->pushes.load() && oldest->next.load() == nullptr)
        return false;
      const int at = oldest->pops.fetch_add(1);
      if (at < places) {
        if (oldest->states[at].exchange(gone) != here) continue;
        task = oldest->tasks[at];
        return true;
      }
      Segment* next = oldest->next.load();
      if (next == nullptr) return false;
      head_.compare_exchange_strong(oldest, next);
    }
  }

 private:
  enum : int { nobody, here, gone };
  struct Segment {
    Segment() {
      for (auto& s : states) s.store(nobody, std::memory_order_relaxed);
    }
    std::atomic<int> pushes{0};
    std::atomic<int> pops{0};
    std::atomic<Segment*> next{nullptr};
    T tasks[places];
    std::atomic<int> states[places];
  };

  Segment* first_ = new Segment;
  std::atomic<Segment*> head_;
  std::atomic<Segment*> tail_;
};

template <class T>
class Chase : public ChaseCase<T, 1024> {
  using ChaseCase<T, 1024>::ChaseCase;
};
template <class T>
class ChaseShort : public ChaseCase<T, 2> {
  using ChaseCase<T, 2>::ChaseCase;
};

}  // namespace irt
