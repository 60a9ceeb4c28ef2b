#include "stress/checker/allocations.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::checker {

void* Allocations::allocate(std::size_t size, std::size_t alignment, const void* pc) {
  ++state_.beats;
  if (size > std::size_t{PTRDIFF_MAX}) return nullptr;  // as malloc does, whatever memory there is
  if (state_.phase != Phase::ageing) {
    alone_.move_on(pc);
    alone_.forget();
    loops_.note_effect();
    any_ = any_ || state_.phase == Phase::parallel;
    if (failed_at_.size() < state_.limits.failing_allocations && loops_.chosen(pc)) {
      failed_at_.emplace_back(state_.current(), pc);
      return nullptr;
    }
  }
  void* block = this->block(size, alignment, pc);
  const auto address = reinterpret_cast<std::uintptr_t>(block);
  state_.note(Look::Kind::allocate, address, size);
  const unsigned thread = state_.current();
  state_.heap.date(address, state_.graph.thread(thread).now.count[thread]);
  // What is there must not depend on the execution before.
  std::memset(block, 0xA5, size);
  return block;
}

// While a queue is aged as malloc does it: what was freed last comes back first.
void* Allocations::block(std::size_t size, std::size_t alignment, const void* pc) {
  Heap& heap = state_.heap;
  const unsigned thread = state_.current();
  const bool ages = state_.phase == Phase::ageing;
  const bool again = (ages || state_.limits.reuse_memory) &&
                     heap.can_reuse(thread, size, alignment) && (ages || loops_.chosen(pc));
  void* block =
      again ? heap.reuse(thread, size, alignment, pc) : heap.allocate(thread, size, alignment, pc);
  if (block == nullptr)
    state_.conclusion.give_up(fmt::format("{} more than {} MB",
                                          ages ? "ageing the queue takes" : "a thread allocates",
                                          Heap::region_bytes >> 20U));
  return block;
}

void Allocations::release(std::uintptr_t address, const void* pc) {
  alone_.move_on(pc);
  alone_.forget();
  state_.note(Look::Kind::release, address, 0);
  Block& block = watch_.free(address, pc);
  loops_.note_effect();
  if (!state_.limits.kept_memory_leaks) freed_from_.insert(block.allocated_at);
  const unsigned thread = state_.current();
  block.freed_after = state_.graph.thread(thread).now.count[thread];
  state_.heap.free(block, thread, pc);
}

unsigned Allocations::failed(unsigned thread) const {
  return static_cast<unsigned>(std::ranges::count_if(
      failed_at_, [thread](const auto& failed) { return failed.first == thread; }));
}

}  // namespace irt::checker

// NOLINTEND(performance-no-int-to-ptr)
