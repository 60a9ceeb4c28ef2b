/// SPLIT: iRT's own way to hand out work: a split deque for each worker, and who has nothing left
/// steals half of what the nearest shares.
///
/// When to use: in the renderer, and wherever tasks make tasks. While all have work a worker
/// touches nothing that others touch, as with LOCAL; once one has none it helps, as with stealing.
/// When not: one worker pushes what all the others pop, for then every pop is a theft; the oldest
/// task must leave first; a worker pushes and then neither comes back nor leaves, for others may
/// not see what it has.
///
/// Ordering: none. *Empty* speaks for this worker: tasks of another may be unseen until its next
/// call. Progress: `push` is wait-free, apart from the allocator, `pop` lock-free. Memory: an array
/// of 8 bytes per place for each worker, which grows and is kept; see split_deque.hpp. Unbounded.
///
/// How it works: a worker pushes to its own deque and pops from there; split_deque.hpp says what of
/// it others see. A thief goes round all others, nearest first (victims.hpp), and brings half of
/// what it finds shared to its own deque, of which it shares again: so work spreads as fast as it
/// doubles, and first within a cache.
#pragma once

#include <string_view>

#include "queues/distributed/split_deque.hpp"
#include "queues/distributed/stealing_queues.hpp"
#include "queues/distributed/victims.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class SplitQueues : public Stealing<T, SplitDeque, NearestVictims, false> {
  using Base = Stealing<T, SplitDeque, NearestVictims, false>;

 public:
  static constexpr std::string_view summary =
      "SPLIT, iRT's own: half-private deques, half stolen, nearest first";
  static constexpr Claims claims = [] {
    Claims claims = Base::claims;
    claims.empty = Answer::this_worker;
    return claims;
  }();
  using Base::Base;
};

}  // namespace irt
