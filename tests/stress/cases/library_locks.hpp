/// Bags under locks of the C and C++ library, taken in unusual ways. What such a call does is not
/// the code's own: no register of the code says how often it was tried, and a sleeper looks again
/// before it sleeps.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <mutex>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <semaphore>
#include <shared_mutex>
#include <string_view>
#include <sys/select.h>
#include <threads.h>
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

/// Sleeps as code in C does: until the time is up of a wait for no file.
class PolledFlag {
 public:
  bool try_lock() {
    while (flag_.test_and_set(std::memory_order_acquire)) {
      poll(nullptr, 0, 1);
      timeval time{0, 1};
      select(0, nullptr, nullptr, nullptr, &time);
    }
    return true;
  }
  void unlock() { flag_.clear(std::memory_order_release); }

 private:
  std::atomic_flag flag_;
};

inline timespec in_a_millisecond() {
  timespec time{};
  clock_gettime(CLOCK_REALTIME, &time);
  time.tv_nsec += 1'000'000;
  if (time.tv_nsec >= 1'000'000'000) {
    time.tv_nsec -= 1'000'000'000;
    ++time.tv_sec;
  }
  return time;
}

/// std::timed_mutex and std::shared_timed_mutex, waited for for a while.
template <class Mutex>
class TimedLock {
 public:
  bool try_lock() { return mutex_.try_lock_for(std::chrono::milliseconds(1)); }
  void unlock() { mutex_.unlock(); }

 private:
  Mutex mutex_;
};

/// A read-write lock by POSIX, whose writers wait for a while.
class TimedReadWriteLock {
 public:
  TimedReadWriteLock() = default;
  TimedReadWriteLock(const TimedReadWriteLock&) = delete;
  TimedReadWriteLock& operator=(const TimedReadWriteLock&) = delete;
  ~TimedReadWriteLock() { pthread_rwlock_destroy(&lock_); }

  bool try_lock() {
    const timespec end = in_a_millisecond();
    return pthread_rwlock_timedwrlock(&lock_, &end) == 0;
  }
  void unlock() { pthread_rwlock_unlock(&lock_); }

 private:
  pthread_rwlock_t lock_ = PTHREAD_RWLOCK_INITIALIZER;
};

/// A semaphore by POSIX, as a lock.
class TimedSemaphore {
 public:
  TimedSemaphore() { sem_init(&free_, 0, 1); }
  TimedSemaphore(const TimedSemaphore&) = delete;
  TimedSemaphore& operator=(const TimedSemaphore&) = delete;
  ~TimedSemaphore() { sem_destroy(&free_); }

  bool try_lock() {
    const timespec end = in_a_millisecond();
    return sem_timedwait(&free_, &end) == 0;
  }
  void unlock() { sem_post(&free_); }

 private:
  sem_t free_{};
};

/// A semaphore by C++, as a lock.
class TimedStandardSemaphore {
 public:
  bool try_lock() { return free_.try_acquire_for(std::chrono::milliseconds(1)); }
  void unlock() { free_.release(); }

 private:
  std::binary_semaphore free_{1};
};

/// A mutex by C11, waited for for a while.
class TimedC11Mutex {
 public:
  TimedC11Mutex() { mtx_init(&mutex_, mtx_timed); }
  TimedC11Mutex(const TimedC11Mutex&) = delete;
  TimedC11Mutex& operator=(const TimedC11Mutex&) = delete;
  ~TimedC11Mutex() { mtx_destroy(&mutex_); }

  bool try_lock() {
    const timespec end = in_a_millisecond();
    return mtx_timedlock(&mutex_, &end) == thrd_success;
  }
  void unlock() { mtx_unlock(&mutex_); }

 private:
  mtx_t mutex_{};
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
using TriedMutexBag = LibraryLocked<T, TriedMutex>;
template <class T>
using TriedSpinLockBag = LibraryLocked<T, TriedSpinLock>;
template <class T>
using SleepingFlagBag = LibraryLocked<T, SleepingFlag>;
template <class T>
using PolledFlagBag = LibraryLocked<T, PolledFlag>;
template <class T>
using GivesUpBug = LibraryLocked<T, TriedSpinLock, 5>;
template <class T>
using GivesUpMutexBug = LibraryLocked<T, std::mutex, 5>;

template <class T>
using TimedMutexBag = LibraryLocked<T, TimedLock<std::timed_mutex>>;
template <class T>
using TimedSharedMutexBag = LibraryLocked<T, TimedLock<std::shared_timed_mutex>>;
template <class T>
using TimedReadWriteBag = LibraryLocked<T, TimedReadWriteLock>;
template <class T>
using TimedSemaphoreBag = LibraryLocked<T, TimedSemaphore>;
template <class T>
using TimedStandardSemaphoreBag = LibraryLocked<T, TimedStandardSemaphore>;
template <class T>
using TimedC11Bag = LibraryLocked<T, TimedC11Mutex>;
template <class T>
using TimesOutMutexBug = LibraryLocked<T, TimedLock<std::timed_mutex>, 1>;
template <class T>
using TimesOutReadWriteBug = LibraryLocked<T, TimedReadWriteLock, 1>;
template <class T>
using TimesOutSemaphoreBug = LibraryLocked<T, TimedSemaphore, 1>;
template <class T>
using TimesOutC11Bug = LibraryLocked<T, TimedC11Mutex, 1>;

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
