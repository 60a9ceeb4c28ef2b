/// LCRQ and LPRQ with aggregating funnels for their tickets (Roh, Wei, Ruppert, Fatourou, Jayanti
/// and Shun 2025, "Aggregating Funnels for Faster Fetch&Add and Queues", PPoPP, section 6).
///
/// When to use: eighty cores and more push and pop all the time. When not: fewer; threads are
/// stopped in the midst of calls; see aggregating_funnel.hpp.
///
/// Ordering: FIFO in real time. Progress: blocking, for a ticket may be another thread's to fetch.
/// Memory: as `lcrq` and `lprq`, and for each ring two funnels. Unbounded.
///
/// How it works: lcrq.hpp and lprq.hpp have the queues, aggregating_funnel.hpp the funnel: one in
/// place of the counter at each end of a ring.
#pragma once

#include <string_view>

#include "queues/lock_free/aggregating_funnel.hpp"
#include "queues/lock_free/closable_ring.hpp"
#include "queues/lock_free/lcrq.hpp"
#include "queues/lock_free/linked_rings.hpp"
#include "queues/lock_free/lprq.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// `claims` without what waiting for another thread's ticket takes away.
constexpr Claims with_funnels(Claims claims) {
  claims.push = Progress::blocking;
  claims.pop = Progress::blocking;
  return claims;
}

template <class T>
class FunnelLcrq : public LinkedRings<T, ClosableRing<CrqPlace, AggregatedTickets<>>> {
 public:
  static constexpr std::string_view summary = "LCRQ whose tickets come by aggregating funnels";
  static constexpr Claims claims = with_funnels(Lcrq<T>::claims);
  using LinkedRings<T, ClosableRing<CrqPlace, AggregatedTickets<>>>::LinkedRings;
};

template <class T>
class FunnelLprq : public LinkedRings<T, ClosableRing<PrqPlace, AggregatedTickets<>>> {
 public:
  static constexpr std::string_view summary = "LPRQ whose tickets come by aggregating funnels";
  static constexpr Claims claims = with_funnels(Lprq<T>::claims);
  using LinkedRings<T, ClosableRing<PrqPlace, AggregatedTickets<>>>::LinkedRings;
};

}  // namespace irt
