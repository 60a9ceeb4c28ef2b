/// Every client of few calls, instead of chosen ones.
#pragma once

#include <string>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::checker {

/// The most calls for which clients are still listed: there are some ten times more with each call.
inline constexpr unsigned most_calls = 6;

/// Every client that makes at least one and at most `calls` pushes and pops, before the threads
/// start and in them, with any number of threads and as far as the claims allow; each as it is, and
/// with every signal of one thread for which one other waits. Where anything is pushed, the queue
/// is emptied at the end, and in a client of its own destroyed as it is. Smaller ones first.
///
/// Up to the order of the threads, and for a bounded queue with each capacity up to what the client
/// pushes, and one at least. Left out is what another one does as well: a prologue before a single
/// thread, a signal before which or a wait after which nothing is done. Clients do not stand for
/// their beginnings: what a call more makes visible could be lost without it.
std::vector<std::string> all_clients(const Claims& claims, unsigned calls);

}  // namespace irt::checker
