/// Queues that go on when a thread stops in their own code, and go through the loader, the
/// allocator and the unwinder all the time, whose locks are not theirs; and queues that hold a lock
/// of their own while they are in the C library.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <dlfcn.h>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <vector>

#include "queues/work_queue.hpp"
#include "stress/mutants/recycled.hpp"

namespace irt::stress {

enum class Machinery { loader, exceptions, allocator, thread_local_storage };

/// A thread-local with a constructor: in a shared object its first use goes through
/// `__tls_get_addr`, later uses as well.
struct Touched {
  Touched() : block(std::make_unique<unsigned>(1)) {}
  std::unique_ptr<unsigned> block;
};
inline thread_local Touched touched;

/// Takes a lock that every thread of the process shares, for longer than the queue takes.
template <Machinery machinery>
void go_through() {
  for (int times = 0; times < 4; ++times) {
    if constexpr (machinery == Machinery::loader) {
      Dl_info info{};
      dladdr(reinterpret_cast<void*>(&touched), &info);
    } else if constexpr (machinery == Machinery::exceptions) {
      try {
        throw std::runtime_error("to be caught");
      } catch (const std::runtime_error&) {
        ++*touched.block;
      }
    } else if constexpr (machinery == Machinery::allocator) {
      delete[] new char[100'000];
    } else {
      ++*touched.block;
    }
  }
}

template <Machinery machinery>
struct Through {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a lock-free list, and machinery that locks";
    static constexpr Claims claims = Recycled<RecycledBug::none>::Queue<T>::claims;

    Queue(unsigned workers, std::size_t capacity) : list_(workers, capacity) {}

    bool push(unsigned worker, T task) {
      go_through<machinery>();
      return list_.push(worker, task);
    }
    bool pop(unsigned worker, T& task) {
      go_through<machinery>();
      return list_.pop(worker, task);
    }

   private:
    typename Recycled<RecycledBug::none>::template Queue<T> list_;
  };
};

/// Boasts to be lock-free, and holds its lock in the C library alone: it naps, or waits for a
/// second lock.
template <bool naps>
struct Sleeps {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a mutex that is held in the C library";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                   .push = Progress::lock_free,
                                   .pop = Progress::lock_free};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned /*worker*/, T task) {
      const std::lock_guard lock(mutex_);
      rest();
      held_.push_back(task);
      return true;
    }
    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(mutex_);
      rest();
      if (held_.empty()) return false;
      task = held_.front();
      held_.erase(held_.begin());
      return true;
    }

   private:
    void rest() {
      if (naps) {
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      } else {
        const std::lock_guard lock(second_);
      }
    }
    std::mutex mutex_;
    std::mutex second_;
    std::vector<T> held_;
  };
};

}  // namespace irt::stress
