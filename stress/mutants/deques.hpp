/// Chase and Lev's work-stealing deques (2005; orders after Lê, Pop, Cohen and Zappa Nardelli 2013,
/// with seq_cst accesses in place of the fences, so that ThreadSanitizer can judge them).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>
#include <type_traits>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::stress {

enum class DequeBug {
  none,
  take_unordered,    ///< M35: take's look at the top may overtake its claim of the bottom
  relaxed_push,      ///< M37: push moves the bottom with a relaxed store
  underflow,         ///< M40: indices are unsigned: taking from a fresh deque wraps below zero
  last_without_cas,  ///< M41: the last element is taken without a compare-and-swap
  read_after_cas,    ///< M42: the thief reads the element after it moved the top
  steal_half,        ///< M44: the thief takes half at once, though the owner may have taken most
};

template <DequeBug bug>
struct Stealing {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a Chase-Lev deque per worker";
    static constexpr Claims claims{.ordering = Ordering::unordered,
                                   .push = Progress::wait_free,
                                   .pop = Progress::lock_free,
                                   .bounded = true,
                                   .reclamation = Reclamation::preallocated};

    Queue(unsigned workers, std::size_t capacity) {
      for (unsigned i = 0; i < workers; ++i) deques_.emplace_back(std::bit_ceil(capacity));
    }

    bool push(unsigned worker, T task) { return deques_[worker].push(task); }

    bool pop(unsigned worker, T& task) {
      if (deques_[worker].take(task)) return true;
      for (bool aborted = true; aborted;) {
        aborted = false;
        for (std::size_t i = 1; i < deques_.size(); ++i) {
          const Theft theft = deques_[(worker + i) % deques_.size()].steal(task, deques_[worker]);
          if (theft == Theft::stolen) return true;
          aborted = aborted || theft == Theft::aborted;
        }
      }
      return false;
    }

   private:
    enum class Theft : std::uint8_t { empty, stolen, aborted };
    using Index = std::conditional_t<bug == DequeBug::underflow, std::uint64_t, std::int64_t>;

    class Deque {
     public:
      explicit Deque(std::size_t capacity) : slots_(capacity) {}

      bool push(T task) {
        const Index bottom = bottom_.load(std::memory_order_relaxed);
        if (bottom - top_.load(std::memory_order_acquire) >= static_cast<Index>(slots_.size())) {
          return false;
        }
        slot(bottom).store(task, std::memory_order_relaxed);
        bottom_.store(bottom + 1, bug == DequeBug::relaxed_push ? std::memory_order_relaxed
                                                                : std::memory_order_release);
        return true;
      }

      bool take(T& task) {
        constexpr auto order =
            bug == DequeBug::take_unordered ? std::memory_order_relaxed : std::memory_order_seq_cst;
        const Index bottom = bottom_.load(std::memory_order_relaxed) - 1;
        bottom_.store(bottom, order);
        Index top = top_.load(order);
        if (top > bottom) {
          bottom_.store(bottom + 1, std::memory_order_relaxed);
          return false;
        }
        task = slot(bottom).load(std::memory_order_relaxed);
        if (top < bottom) return true;
        bool won = true;
        if (bug == DequeBug::last_without_cas) {
          top_.store(top + 1);
        } else {
          won = top_.compare_exchange_strong(top, top + 1);
        }
        bottom_.store(bottom + 1, std::memory_order_relaxed);
        return won;
      }

      /// Takes from the other end; `own` is the thief's deque.
      Theft steal(T& task, Deque& own) {
        Index top = top_.load();
        const Index bottom = bottom_.load();
        if (top >= bottom) return Theft::empty;
        const Index count = bug == DequeBug::steal_half ? (bottom - top + 1) / 2 : 1;
        std::vector<T> taken;
        if (bug == DequeBug::steal_half) {
          for (Index i = 1; i < count; ++i) taken.push_back(slot(top + i).load());
        }
        T value = slot(top).load(std::memory_order_relaxed);
        const Index place = top;
        if (!top_.compare_exchange_strong(top, top + count)) return Theft::aborted;
        if (bug == DequeBug::read_after_cas) value = slot(place).load(std::memory_order_relaxed);
        task = value;
        for (const T& more : taken) own.push(more);
        return Theft::stolen;
      }

     private:
      std::atomic<T>& slot(Index at) {
        return slots_[static_cast<std::size_t>(at) & (slots_.size() - 1)];
      }
      alignas(128) std::atomic<Index> top_{0};
      alignas(128) std::atomic<Index> bottom_{0};
      std::vector<std::atomic<T>> slots_;
    };

    std::deque<Deque> deques_;
  };
};

}  // namespace irt::stress
