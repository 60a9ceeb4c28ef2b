/// LFREE and Vyukov's ring behind an event count, so that their pop may wait.
///
/// When to use: workers that find nothing should sleep, and the queue must be lock-free, or
/// bounded. When not: the queue `mutex` waits by itself, and is cheaper where every push is under a
/// lock anyway.
///
/// Ordering, progress, memory, bounds: those of the queue inside.
///
/// How it works: waiting_queue.hpp puts the event count around any queue.
#pragma once

#include <string_view>

#include "queues/blocking/waiting_queue.hpp"
#include "queues/lock_free/michael_scott_queue.hpp"
#include "queues/lock_free/vyukov_ring.hpp"

namespace irt {

/// *Empty* is exact by happens-before.
template <class T>
class WaitingMichaelScottQueue : public Waiting<MichaelScottQueue>::Queue<T> {
 public:
  static constexpr std::string_view summary = "LFREE behind an event count: its pop may wait";
  using Waiting<MichaelScottQueue>::Queue<T>::Queue;
};

/// Bounded, and its *empty* may stand for a push in flight.
template <class T>
class WaitingVyukovRing : public Waiting<VyukovRing>::Queue<T> {
 public:
  static constexpr std::string_view summary =
      "Vyukov's ring behind an event count: its pop may wait";
  using Waiting<VyukovRing>::Queue<T>::Queue;
};

}  // namespace irt
