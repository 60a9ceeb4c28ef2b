/// A deque under one lock that spins: MUTEX with a ticket lock or an MCS lock in place of the
/// mutex.
///
/// When to use: to see what of MUTEX is the mutex: here a thread that waits stays awake, and the
/// lock is handed over in the order in which it was asked for. When not: more threads than cores,
/// for the lock then goes to threads that have none; or a pop has to wait, which MUTEX knows how
/// to.
///
/// Ordering: FIFO in real time; the lock puts all operations into one order. Progress: blocking.
/// Memory: blocks of the deque, returned as they empty. Unbounded.
///
/// How it works: as MUTEX. The allocator is called inside the lock, once for each block.
#pragma once

#include <cstddef>
#include <deque>
#include <string_view>
#include <utility>

#include "queues/blocking/mcs_lock.hpp"
#include "queues/blocking/ticket_lock.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T, class Lock>
class LockedDeque {
 public:
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  LockedDeque(unsigned /*workers*/, std::size_t /*capacity*/) {}

  /// Adds `task` at the back. Blocking. Always true.
  bool push(unsigned /*worker*/, T task) {
    const typename Lock::Guard guard(lock_);
    tasks_.push_back(std::move(task));
    return true;
  }

  /// Takes the oldest task; false if there is none. Blocking.
  bool pop(unsigned /*worker*/, T& task) {
    const typename Lock::Guard guard(lock_);
    if (tasks_.empty()) return false;
    task = std::move(tasks_.front());
    tasks_.pop_front();
    return true;
  }

 private:
  Lock lock_;
  std::deque<T> tasks_;
};

template <class T>
class TicketLockedDeque : public LockedDeque<T, TicketLock> {
 public:
  static constexpr std::string_view summary = "a deque under one ticket lock";
  using LockedDeque<T, TicketLock>::LockedDeque;
};

template <class T>
class McsLockedDeque : public LockedDeque<T, McsLock> {
 public:
  static constexpr std::string_view summary = "a deque under one MCS lock";
  using LockedDeque<T, McsLock>::LockedDeque;
};

}  // namespace irt
