/// Three queues with nothing wrong, each of a kind that was accused: a bounded spin of ten thousand
/// looks before giving up ("livelock"), a global registry of blocks for threads that lives as long
/// as the process
/// ("leak"), and a std::list under a mutex, whose links are written by compiled code of the C++
/// library
/// ("read of uninitialised memory").
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <list>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

/// A Vyukov-like ring for many whose pop waits a bounded while for a push that is under way.
template <class T>
class LongSpin {
 public:
  static constexpr std::string_view summary =
      "a ring under two locks that looks 10,000 times for a push under way";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .bounded = true,
                                 .reclamation = Reclamation::preallocated};

  LongSpin(unsigned /*workers*/, std::size_t capacity)
      : places_(std::max<std::size_t>(capacity, 1)), full_(places_.size()) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(pushing_);
    const std::size_t at = pushed_.load(std::memory_order_relaxed);
    if (at - popped_.load(std::memory_order_acquire) == places_.size()) return false;
    pushed_.store(at + 1, std::memory_order_release);  // announced first, filled then
    places_[at % places_.size()] = task;
    full_[at % places_.size()].store(true, std::memory_order_release);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(popping_);
    const std::size_t at = popped_.load(std::memory_order_relaxed);
    if (at == pushed_.load(std::memory_order_acquire)) return false;
    auto& full = full_[at % places_.size()];
    for (;;) {
      for (int looks = 0; looks < 10'000; ++looks) {
        if (!full.load(std::memory_order_acquire)) continue;
        task = places_[at % places_.size()];
        full.store(false, std::memory_order_relaxed);
        popped_.store(at + 1, std::memory_order_release);
        return true;
      }
    }
  }

 private:
  std::vector<T> places_;
  std::vector<std::atomic<bool>> full_;
  std::mutex pushing_, popping_;
  std::atomic<std::size_t> pushed_{0};
  std::atomic<std::size_t> popped_{0};
};

/// A mutex and a vector, and a block for each worker in a list that nobody ever frees.
template <class T>
class Registry {
 public:
  static constexpr std::string_view summary =
      "a registry of blocks that lives as long as the process";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  Registry(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    ++mine().calls;
    tasks_.push_back(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    ++mine().calls;
    if (tasks_.empty()) return false;
    task = tasks_.front();
    tasks_.erase(tasks_.begin());
    return true;
  }

 private:
  struct Block {
    std::size_t calls = 0;
    Block* next = nullptr;
  };

  static Block& mine() {
    static thread_local Block* block = nullptr;
    if (block == nullptr) {
      block = new Block;
      block->next = registry().load(std::memory_order_relaxed);
      while (!registry().compare_exchange_weak(block->next, block, std::memory_order_release,
                                               std::memory_order_relaxed)) {
      }
    }
    return *block;
  }
  static std::atomic<Block*>& registry() {
    static std::atomic<Block*> first{nullptr};
    return first;
  }

  std::mutex mutex_;
  std::vector<T> tasks_;
};

/// std::list under one mutex.
template <class T>
class ListQueue {
 public:
  static constexpr std::string_view summary = "std::list under one mutex";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  ListQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    if (tasks_.empty()) return false;
    task = tasks_.front();
    tasks_.pop_front();
    return true;
  }

 private:
  std::mutex mutex_;
  std::list<T> tasks_;
};

}  // namespace irt
