/// JCTools/JCTools#355 (2021), netty/netty#13137 (2023), JCTools#242: a producer marks the index
/// "being grown" and allocates; where the allocation fails the mark stays, and everybody waits.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <thread>
#include <utility>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool Fixed>
class FailedGrowthCase {
 public:
  static constexpr std::string_view summary =
      "MPSC list of arrays, odd index: growing (JCTools#355)";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .consumers = Callers::one};

  FailedGrowthCase(unsigned /*workers*/, std::size_t /*capacity*/)
      : first_(new Segment), last_(first_) {}
  FailedGrowthCase(const FailedGrowthCase&) = delete;
  FailedGrowthCase& operator=(const FailedGrowthCase&) = delete;
  ~FailedGrowthCase() {
    for (Segment* s = first_; s != nullptr;) delete std::exchange(s, s->next.load());
  }

  bool push(unsigned /*worker*/, T task) {
    for (;;) {
      std::uint64_t at = index_.load();
      if (at % 2 != 0) {
        std::this_thread::yield();
        continue;
      }
      const std::uint64_t place = at / 2 % size;
      if (place == 0 && at != 0) {
        if (!index_.compare_exchange_strong(at, at + 1)) continue;
        grow(at, task);
        return true;
      }
      Segment* segment = last_.load();
      if (!index_.compare_exchange_strong(at, at + 2)) continue;
      segment->set(place, task);
      return true;
    }
  }

  bool pop(unsigned /*worker*/, T& task) {
    if (popped_ != 0 && popped_ % size == 0 && !moved_) {
      Segment* next = first_->next.load(std::memory_order_acquire);
      if (next == nullptr) return false;
      delete std::exchange(first_, next);
      moved_ = true;
    }
    if (!first_->ready[popped_ % size].load(std::memory_order_acquire)) return false;
    task = first_->tasks[popped_ % size];
    ++popped_;
    moved_ = false;
    return true;
  }

 private:
  static constexpr std::uint64_t size = 2;
  struct Segment {
    void set(std::uint64_t place, T task) {
      tasks[place] = task;
      ready[place].store(true, std::memory_order_release);
    }
    std::array<T, size> tasks{};
    std::array<std::atomic<bool>, size> ready{};
    std::atomic<Segment*> next{nullptr};
  };

  void grow(std::uint64_t at, T task) {
    Segment* fresh = nullptr;
    if (Fixed) {
      try {
        fresh = new Segment;
      } catch (...) {
        index_.store(at);
        throw;
      }
    } else {
      fresh = new Segment;
    }
    fresh->set(0, task);
    last_.load()->next.store(fresh, std::memory_order_release);
    last_.store(fresh);
    index_.store(at + 2);
  }

  alignas(128) Segment* first_;  // the consumer's
  std::uint64_t popped_ = 0;
  bool moved_ = false;
  alignas(128) std::atomic<std::uint64_t> index_{0};
  std::atomic<Segment*> last_;
};

template <class T>
class FailedGrowthBug : public FailedGrowthCase<T, false> {
  using FailedGrowthCase<T, false>::FailedGrowthCase;
};
template <class T>
class FailedGrowthFixed : public FailedGrowthCase<T, true> {
  using FailedGrowthCase<T, true>::FailedGrowthCase;
};

}  // namespace irt
