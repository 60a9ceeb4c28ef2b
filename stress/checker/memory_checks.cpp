// What is wrong with an access to memory, whatever it reads: races, lifetimes, bounds.

#include <algorithm>
#include <cstring>

#include "stress/checker/execution.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::checker {

namespace {

const char* verb(bool writes) {
  return writes ? "write" : "read";
}

}  // namespace

void Execution::check_touch(std::uintptr_t address, std::size_t size, bool writes, bool atomic,
                            const void* pc) {
  constexpr std::uint64_t most = 1'000'000;
  if (++touches_ > most)
    report(FindingKind::livelock,
           "no end within " + std::to_string(most) + " accesses to memory; a thread is at {0}",
           {pc});
  // Only what threads do at the same time can race.
  const bool shared = phase_ == Phase::parallel;
  if (!shared && !heap_.owns(address)) return;
  const unsigned thread = cores_.current();
  const Clock& now = graph_.thread(thread).now;
  const auto moment = static_cast<std::uint16_t>(now.count[thread] + 1);
  const std::uintptr_t end = address + size;
  bool initialised = false;
  for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < end; at += 8) {
    const std::uintptr_t from = std::max(at, address);
    const auto count = static_cast<unsigned>(std::min(end, at + 8) - from);
    const auto bytes = static_cast<std::uint8_t>(((1U << count) - 1) << (from - at));
    Cell& cell = heap_.cell(at);
    if (heap_.owns(at)) {
      if (cell.block == 0)
        report(FindingKind::out_of_bounds,
               std::string("the ") + verb(writes) + " at {0} is outside of every block of the heap",
               {pc});
      const Block& block = heap_.block(cell.block);
      if (block.freed)
        report(FindingKind::use_after_free,
               std::string("the ") + verb(writes) + " at {0} by thread " + std::to_string(thread) +
                   " is to memory that thread " + std::to_string(block.freed_by) +
                   " freed at {1} (allocated at {2})",
               {pc, block.freed_at, block.allocated_at});
      if (from < block.address || from + count > block.address + block.size)
        report(FindingKind::out_of_bounds,
               std::string("the ") + verb(writes) + " at {0} is past the end of the block of " +
                   std::to_string(block.size) + " bytes that was allocated at {1}",
               {pc, block.allocated_at});
    }
    for (std::uint32_t number = shared && limits_.races ? cell.touches : 0; number != 0;) {
      const Touch& other = heap_.touch(number);
      number = other.next;
      if (other.thread == thread || (other.bytes & bytes) == 0 || !(other.writes || writes) ||
          (other.atomic && atomic) || now.count[other.thread] >= other.moment)
        continue;
      report(FindingKind::data_race,
             std::string("the ") + (atomic ? "atomic " : "") + verb(writes) + " at {0} by thread " +
                 std::to_string(thread) + " and the " + (other.atomic ? "atomic " : "") +
                 verb(other.writes) + " at {1} by thread " + std::to_string(other.thread) +
                 " are to the same memory, and neither happens before the other",
             {pc, other.pc});
    }
    initialised = initialised || (cell.initialised & bytes) != 0;
    if (writes) {
      cell.initialised = static_cast<std::uint8_t>(cell.initialised | bytes);
      if (!atomic && cell.location != 0)
        cell.replaced = static_cast<std::uint8_t>(cell.replaced | bytes);
    }
    if (shared)
      heap_.add_touch(cell,
                      {static_cast<std::uint8_t>(thread), bytes, writes, atomic, moment, 0, pc});
  }
  if (!initialised && size <= 8 && (!writes || atomic) && heap_.owns(address)) {
    const Block& block = *heap_.find(address);
    if (!writes)
      report(FindingKind::uninitialised_read,
             "the read at {0} is of memory that nothing was written to since it was allocated at "
             "{1}",
             {pc, block.allocated_at});
  }
}

void Execution::plain_read(std::uintptr_t address, std::size_t size, const void* pc) {
  if (!observed() || on_own_stack(address)) return;
  check_touch(address, size, false, false, pc);
}

void Execution::plain_write(std::uintptr_t address, std::size_t size, const void* pc) {
  if (!observed()) return;
  if (on_own_stack(address)) {
    // Frames come and go at one address, so stacks are not watched; but an atomic object that
    // was there ends with the next write to its place.
    if (!stack_locations_) return;
    for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < address + size; at += 8)
      if (Cell& cell = heap_.cell(at); cell.location != 0) cell.replaced = 0xFF;
    return;
  }
  ++me().effects;
  check_touch(address, size, true, false, pc);
}

void* Execution::allocate(std::size_t size, std::size_t alignment, const void* pc) {
  if (!observed()) return Tenant::allocate(size, alignment, pc);
  ++me().effects;
  void* block = heap_.allocate(cores_.current(), size, alignment, pc, limits_.reuse_memory);
  // What is there must not depend on the execution before.
  if (block != nullptr) std::memset(block, 0xA5, size);
  return block;
}

void Execution::release(void* pointer, const void* pc) {
  const auto address = reinterpret_cast<std::uintptr_t>(pointer);
  if (!heap_.owns(address)) return Tenant::release(pointer, pc);
  const unsigned thread = cores_.current();
  Block* block = heap_.find(address);
  if (block == nullptr || block->address != address)
    return report(FindingKind::invalid_free, "what is freed at {0} is not the beginning of a block",
                  {pc});
  if (block->freed)
    report(FindingKind::invalid_free,
           "thread " + std::to_string(thread) + " frees at {0} what thread " +
               std::to_string(block->freed_by) + " freed at {1} (allocated at {2})",
           {pc, block->freed_at, block->allocated_at});
  const Clock& now = graph_.thread(thread).now;
  for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < address + block->size; at += 8) {
    for (std::uint32_t number = heap_.cell(at).touches; number != 0;) {
      const Touch& touch = heap_.touch(number);
      number = touch.next;
      if (touch.thread == thread || now.count[touch.thread] >= touch.moment) continue;
      report(FindingKind::use_after_free,
             "thread " + std::to_string(thread) + " frees at {0} what thread " +
                 std::to_string(touch.thread) + " still " + (touch.writes ? "writes" : "reads") +
                 " at {1} (allocated at {2}): nothing makes " + "the access happen before",
             {pc, touch.pc, block->allocated_at});
    }
  }
  ++me().effects;
  heap_.free(*block, thread, pc);
}

std::size_t Execution::block_size(void* pointer) {
  const Block* block = heap_.find(reinterpret_cast<std::uintptr_t>(pointer));
  return block == nullptr ? Tenant::block_size(pointer) : block->size;
}

}  // namespace irt::checker

// NOLINTEND(performance-no-int-to-ptr)
