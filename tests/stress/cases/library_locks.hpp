/// Bags under locks of the C and C++ library, taken in unusual ways. What such a call does is not
/// the code's own: no register of the code says how often it was tried, and a sleeper looks again
/// before it sleeps.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <pthread.h>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

/// std::mutex, tried after a look at a flag.
class TriedMutex {
 public:
  bool try_lock() {
    while (held_.load(std::memory_order_relaxed)) {
    }
    if (!mutex_.try_lock()) return false;
    held_.store(true, std::memory_order_relaxed);
    return true;
  }
  void unlock() {
    held_.store(false, std::memory_order_relaxed);
    mutex_.unlock();
  }

 private:
  std::atomic<bool> held_{false};
  std::mutex mutex_;
};

class TriedSpinLock {
 public:
  TriedSpinLock() { pthread_spin_init(&lock_, PTHREAD_PROCESS_PRIVATE); }
  bool try_lock() { return pthread_spin_trylock(&lock_) == 0; }
  void unlock() { pthread_spin_unlock(&lock_); }

 private:
  pthread_spinlock_t lock_;
};

/// Locks by sleeping until a flag is clear.
class SleepingFlag {
 public:
  bool try_lock() {
    while (flag_.test_and_set(std::memory_order_acquire))
      flag_.wait(true, std::memory_order_relaxed);
    return true;
  }
  void unlock() {
    flag_.clear(std::memory_order_release);
    flag_.notify_one();
  }

 private:
  std::atomic_flag flag_;
};

/// With `patience` a pop that finds the lock taken so often goes on without it, which is a bug.
template <class T, class Lock, unsigned patience = 0>
class LibraryLocked {
 public:
  static constexpr std::string_view summary = "a bag under a lock of the library";
  static constexpr Claims claims{.survives_no_memory = false};

  LibraryLocked(unsigned /*workers*/, std::size_t /*capacity*/) { tasks_.reserve(400); }

  bool push(unsigned /*worker*/, T task) {
    while (!lock_.try_lock()) {
    }
    tasks_.push_back(task);
    lock_.unlock();
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    // The last operation of the code itself before the library's: what it left behind is the same
    // whenever the lock is tried.
    pops_.fetch_add(1, std::memory_order_relaxed);
    bool locked = lock_.try_lock();
    for (unsigned tries = 1; !locked && (patience == 0 || tries < patience); ++tries)
      locked = lock_.try_lock();
    const bool found = !tasks_.empty();
    if (found) {
      task = tasks_.back();
      tasks_.pop_back();
    }
    if (locked) lock_.unlock();
    return found;
  }

 private:
  std::atomic<unsigned> pops_{0};
  Lock lock_;
  std::vector<T> tasks_;
};

template <class T>
class TriedMutexBag : public LibraryLocked<T, TriedMutex> {
  using LibraryLocked<T, TriedMutex>::LibraryLocked;
};
template <class T>
class TriedSpinLockBag : public LibraryLocked<T, TriedSpinLock> {
  using LibraryLocked<T, TriedSpinLock>::LibraryLocked;
};
template <class T>
class SleepingFlagBag : public LibraryLocked<T, SleepingFlag> {
  using LibraryLocked<T, SleepingFlag>::LibraryLocked;
};
template <class T>
class GivesUpBug : public LibraryLocked<T, TriedSpinLock, 5> {
  using LibraryLocked<T, TriedSpinLock, 5>::LibraryLocked;
};
template <class T>
class GivesUpMutexBug : public LibraryLocked<T, std::mutex, 5> {
  using LibraryLocked<T, std::mutex, 5>::LibraryLocked;
};

/// A pop that finds nothing looks at the clock for an hour.
template <class T>
class WaitsByTheClock : public LibraryLocked<T, std::mutex> {
 public:
  using LibraryLocked<T, std::mutex>::LibraryLocked;

  bool pop(unsigned worker, T& task) {
    if (LibraryLocked<T, std::mutex>::pop(worker, task)) return true;
    const auto end = std::chrono::steady_clock::now() + std::chrono::hours(1);
    while (std::chrono::steady_clock::now() < end) {
    }
    return false;
  }
};

}  // namespace irt
