/// The simulator's pairs on real threads, to compare with.
#pragma once

#include <vector>

#include "queues/work_queue.hpp"

namespace irt::many_core {

/// Operations per second of `threads` threads, each bound to a processor of its own: push, work for
/// about `work_ns`, pop until it succeeds, work. One value per repetition of `seconds`.
std::vector<double> measure_pairs(const QueueEntry& queue, unsigned threads, double work_ns,
                                  double seconds, unsigned repetitions);

}  // namespace irt::many_core
