/// LOCK with locks that spin, in place of the mutex at each end.
///
/// When to use: to see what of LOCK is the mutex: here who waits stays awake, and a lock is handed
/// over in the order in which it was asked for. When not: more threads than cores, for the lock
/// then goes to threads that have none.
///
/// Ordering, progress, memory, bounds: those of LOCK.
///
/// How it works: two_lock_queue.hpp has the list, ticket_lock.hpp and mcs_lock.hpp the locks.
#pragma once

#include <string_view>

#include "queues/blocking/mcs_lock.hpp"
#include "queues/blocking/ticket_lock.hpp"
#include "queues/blocking/two_lock_queue.hpp"

namespace irt {

template <class T>
class TicketTwoLockQueue : public TwoLockList<T, TicketLock> {
 public:
  static constexpr std::string_view summary = "LOCK with one ticket lock for each end";
  using TwoLockList<T, TicketLock>::TwoLockList;
};

template <class T>
class McsTwoLockQueue : public TwoLockList<T, McsLock> {
 public:
  static constexpr std::string_view summary = "LOCK with one MCS lock for each end";
  using TwoLockList<T, McsLock>::TwoLockList;
};

}  // namespace irt
