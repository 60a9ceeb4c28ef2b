/// What the claims of a queue mean: the one place that says which answers are right.
///
/// `judge_in_every_order` (orders.hpp) asks it at each point of each order of a few calls; the
/// oracles of long histories (judge.hpp) ask with bounds on what they cannot know. Neither adds to
/// it, so that no tool accuses a queue of what another accepts; a bound costs power only.
///
/// | claim | *empty* | *full*, of a bounded queue | order |
/// |---|---|---|---|
/// | `unordered` | calls in flight | calls in flight | none |
/// | `per_producer_fifo` | calls in flight | calls in flight | of each producer's elements |
/// | `k_relaxed_fifo` | calls in flight | calls in flight | passes at most k older elements |
/// | `fifo_happens_before`, `fifo_real_time` | exact | exact | passes no older element |
/// | `.empty`, `.full` | as claimed | as claimed | |
///
/// By happens-before alone there is one order in which all *full* are true, one in which all
/// *empty* are, and for each *full* and *empty* of which one happens before the other one in which
/// these two are. One for all would be too much: a producer that does not see a pop yet and a
/// consumer that does not see a push yet are both right, as loads and stores that acquire and
/// release are (store buffering). In real time one order makes all of them true.
///
/// A waiting pop that is told that the queue is closed, or that gives up, has seen it empty in the
/// sense of the table; closing.hpp has what closing promises besides.
///
/// Whatever the claims: an element leaves once, after its push was called and not before; what was
/// accepted comes out; an unbounded queue is never full; where each worker has a queue of its own,
/// all of this holds for each by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "queues/work_queue.hpp"

namespace irt::stress {

/// Calls of other workers in flight during a call: neither happens before the other.
struct InFlight {
  std::uint64_t pushes = 0;   ///< that were accepted
  std::uint64_t pops = 0;     ///< that took an element
  std::uint64_t refused = 0;  ///< workers of which a push answered *full*
  /// Whether some pop that answered *empty* can have begun or ended while none of the elements was
  /// inside that were inside all the while that the call lasted.
  bool doubtful_empty = false;
};

class Specification {
 public:
  /// For a queue made with `capacity`, in elements.
  Specification(const Claims& claims, std::size_t capacity)
      : claims_(claims), capacity_(capacity) {}

  [[nodiscard]] const Claims& claims() const { return claims_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

  /// FIFO over all elements.
  [[nodiscard]] bool fifo() const {
    return claims_.ordering == Ordering::fifo_happens_before ||
           claims_.ordering == Ordering::fifo_real_time;
  }
  /// What the answers speak of; never `by_ordering`.
  [[nodiscard]] Answer full() const { return resolved(claims_.full); }
  [[nodiscard]] Answer empty() const { return resolved(claims_.empty); }

  /// How many older elements a pop may pass.
  [[nodiscard]] std::uint64_t overtakes() const {
    if (fifo()) return 0;
    if (claims_.ordering == Ordering::k_relaxed_fifo) return claims_.relaxation;
    return std::numeric_limits<std::uint64_t>::max();
  }

  /// Whether *full* is right with `inside` elements inside: exactly so many, or at most.
  [[nodiscard]] bool allows_full(std::uint64_t inside, const InFlight& in_flight) const {
    if (!claims_.bounded) return false;
    if (inside >= capacity_) return true;
    if (full() == Answer::exact) return false;
    return in_flight.pops > 0 || inside + in_flight.refused >= capacity_;
  }

  /// Whether *empty* is right although an element was inside all the while. `found_again`: the same
  /// worker then took it, and nobody else did anything in between.
  [[nodiscard]] bool allows_empty(const InFlight& in_flight, bool found_again) const {
    switch (empty()) {
      case Answer::this_worker:
        return !found_again;
      case Answer::calls_in_flight:
        return in_flight.pushes > 0 || in_flight.pops > 0 || in_flight.doubtful_empty;
      default:
        return false;
    }
  }

  /// Whether a push finds a place, and a pop finds what was pushed, while another thread is stopped
  /// for good: progress is claimed, and no claim says that the answer waits for calls in flight.
  [[nodiscard]] bool pushes_past_stopped() const {
    return claims_.push != Progress::blocking && claims_.full != Answer::calls_in_flight;
  }
  [[nodiscard]] bool pops_past_stopped() const {
    return claims_.pop != Progress::blocking && claims_.empty != Answer::calls_in_flight &&
           claims_.empty != Answer::this_worker;
  }

 private:
  [[nodiscard]] Answer resolved(Answer claimed) const {
    if (claimed != Answer::by_ordering) return claimed;
    return fifo() ? Answer::exact : Answer::calls_in_flight;
  }

  Claims claims_;
  std::size_t capacity_;
};

}  // namespace irt::stress
