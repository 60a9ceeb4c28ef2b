/// Memory that is lost: blocks that were never freed and that nothing leads to any more.
///
/// A block that a global variable leads to, directly or by way of other blocks, is kept on purpose:
/// a registry, a cache, a domain of hazard pointers. Words are taken for pointers wherever they
/// could be one, with marks in their lowest or highest bits, as LeakSanitizer does; so a leak may
/// be missed, and none is made up.
#pragma once

#include <span>
#include <vector>

#include "stress/checker/heap.hpp"
#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

/// The lost blocks that no other lost block leads to, in the order of allocation, or if they go
/// round in a circle the first of all. `roots` is the memory that is in use.
std::vector<const Block*> lost_blocks(Heap& heap, std::span<const virtual_cores::Range> roots);

}  // namespace irt::checker
