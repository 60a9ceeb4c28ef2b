/// The shapes that every queue is tried with, chosen by what it claims.
#pragma once

#include <string>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::checker {

/// Those of `shapes` that a queue with these claims and optional methods allows.
std::vector<std::string> fitting(const std::vector<std::string>& shapes, const Claims& claims,
                                 const Methods& methods = {});

/// The shapes that a queue with these claims and optional methods is tried with, small ones first.
std::vector<std::string> battery(const Claims& claims, const Methods& methods = {});

/// Shapes of an aged queue, and of a large one: counters of 8 and 16 bits wrap in them. Ordered by
/// capacity, then by age. `old`: of 32 bits instead, which takes minutes.
std::vector<std::string> aged_battery(const Claims& claims, bool old = false);

/// The shape in which each of `threads` pushes `operations` elements and pops as many, as far as
/// the claims let it: a role for one goes to the first thread (pushing) and to the last (popping).
/// Empty if that leaves a thread without steps.
std::string even_shape(const Claims& claims, unsigned threads, unsigned operations);

}  // namespace irt::checker
