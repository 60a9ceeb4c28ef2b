/// Queues with a thread that waits for what nobody will bring any more.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>
#include <thread>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::stress {

/// M47: a pop that finds the ticket lock busy gives up after a few looks, and leaves the ticket
/// that it has drawn: when its turn comes nobody is there to pass it on. The healthy twin draws one
/// only if it will be served at once.
template <bool draws_late>
struct Ticketed {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a list under a ticket lock; pop gives up";
    static constexpr Claims claims{.ordering = Ordering::per_producer_fifo};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned /*worker*/, T task) {
      const std::uint64_t mine = next_.fetch_add(1, std::memory_order_relaxed);
      // (1) acquire: pairs with the release store (2)
      while (served_.load(std::memory_order_acquire) != mine) std::this_thread::yield();
      held_.push_back(task);
      leave(mine);
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      std::uint64_t mine = 0;
      if (!enter(mine)) return false;
      const bool found = !held_.empty();
      if (found) {
        task = held_.front();
        held_.pop_front();
      }
      leave(mine);
      return found;
    }

   private:
    bool enter(std::uint64_t& mine) {
      if (draws_late) {
        // (1) acquire: pairs with the release store (2)
        mine = served_.load(std::memory_order_acquire);
        std::uint64_t free = mine;
        return next_.compare_exchange_strong(free, mine + 1, std::memory_order_relaxed);
      }
      mine = next_.fetch_add(1, std::memory_order_relaxed);
      for (int looks = 0; looks < 3; ++looks)
        if (served_.load(std::memory_order_acquire) == mine) return true;
      return false;
    }
    void leave(std::uint64_t mine) {
      // (2) release: pairs with the acquire loads (1)
      served_.store(mine + 1, std::memory_order_release);
    }

    std::atomic<std::uint64_t> next_{0};
    std::atomic<std::uint64_t> served_{0};
    std::deque<T> held_;
  };
};

/// M48: a pop waits for the push of the place that it has seen at the head, and does not look at
/// the head again: another pop takes the element, the place goes to a later push, and its turn
/// never comes back. The healthy twin looks.
template <bool looks_again>
struct Overtaken {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a ring whose pops wait for a push under way";
    static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                   .bounded = true,
                                   .reclamation = Reclamation::preallocated};

    Queue(unsigned /*workers*/, std::size_t capacity) : places_(capacity < 1 ? 1 : capacity) {}

    bool push(unsigned /*worker*/, T task) {
      std::uint64_t at = tail_.load();
      do {
        if (at - head_.load() >= places_.size()) return false;
      } while (!tail_.compare_exchange_weak(at, at + 1));
      Place& place = places_[at % places_.size()];
      place.task.store(task);
      place.turn.store(at + 1);
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      for (;;) {
        std::uint64_t at = head_.load();
        if (at == tail_.load()) return false;
        Place& place = places_[at % places_.size()];
        bool overtaken = false;
        while (!overtaken && place.turn.load() != at + 1) {
          std::this_thread::yield();
          overtaken = looks_again && head_.load() != at;
        }
        if (overtaken) continue;
        task = place.task.load();
        if (head_.compare_exchange_strong(at, at + 1)) return true;
      }
    }

   private:
    struct Place {
      std::atomic<std::uint64_t> turn{0};
      std::atomic<T> task{};
    };
    std::vector<Place> places_;
    alignas(128) std::atomic<std::uint64_t> head_{0};
    alignas(128) std::atomic<std::uint64_t> tail_{0};
  };
};

}  // namespace irt::stress
