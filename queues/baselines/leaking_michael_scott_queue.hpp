/// LFREE without reclamation: what hazard pointers cost is the difference between the two.
///
/// When to use: as a baseline in measurements. When not: in a program; memory grows with every
/// push.
///
/// Ordering: FIFO by happens-before. Progress: lock-free, apart from the allocator. Memory: one
/// node per task, from the allocator, freed when the queue is destroyed. Unbounded.
///
/// How it works: see lock_free/michael_scott_queue.hpp. No node is used twice, so nothing can be
/// taken for something else (ABA).
#pragma once

#include <string_view>

#include "queues/lock_free/michael_scott_queue.hpp"
#include "queues/reclamation/keep_all.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class LeakingMichaelScottQueue : public MichaelScottList<T, KeepAll> {
 public:
  static constexpr std::string_view summary = "LFREE that never frees a node: a baseline";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::at_destruction};
  using MichaelScottList<T, KeepAll>::MichaelScottList;
};

}  // namespace irt
