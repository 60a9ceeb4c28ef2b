/// LOCK with locks that spin: see `two_lock_queue.hpp`, and the locks for when to use which.
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
