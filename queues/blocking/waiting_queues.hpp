/// The queues of the tree that are registered with a pop that waits: see `waiting_queue.hpp`.
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
