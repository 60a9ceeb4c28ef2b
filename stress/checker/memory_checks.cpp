// What is wrong with an access to memory, whatever it reads: races, lifetimes, bounds.

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

#include "stress/checker/execution.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::checker {

namespace {

constexpr std::uint64_t longest_walk = 200'000'000;

const char* verb(bool writes) {
  return writes ? "write" : "read";
}

}  // namespace

void Execution::check_touch(std::uintptr_t address, std::size_t size, bool writes, bool atomic,
                            const void* pc) {
  ++beats_;
  if (++walk_ > long_walk) check_walk(address, size, writes, atomic, pc);
  // Only what threads do at the same time can race.
  const bool shared = phase_ == Phase::parallel;
  if (!shared && !heap_.owns(address)) return;
  const unsigned thread = cores_.current();
  Touch touch{static_cast<std::uint8_t>(thread), 0, writes, atomic, 0, 0, pc};
  touch.moment = static_cast<std::uint16_t>(graph_.thread(thread).now.count[thread] + 1);
  const auto touch_cell = [&](std::uintptr_t at, unsigned bytes) {
    Cell& cell = heap_.cell(at);
    if ((bytes & ~cell.usable) != 0) report_unusable(at, writes, atomic, pc);
    if (shared) {
      touch.bytes = static_cast<std::uint8_t>(bytes);
      if (cell.toucher != thread + 1 && cell.toucher != 0 && limits_.races) check_race(cell, touch);
      heap_.add_touch(cell, touch);
    }
    const bool initialised = (cell.initialised & bytes) != 0;
    if (writes) {
      cell.initialised = static_cast<std::uint8_t>(cell.initialised | bytes);
      if (!atomic && cell.location != 0)
        cell.replaced = static_cast<std::uint8_t>(cell.replaced | bytes);
    }
    return initialised;
  };
  const auto bits = [](std::size_t count) { return (1U << count) - 1; };
  const std::uintptr_t first = address & ~std::uintptr_t{7};
  const std::uintptr_t end = address + size;
  if (end > first + 8) {
    touch_cell(first, bits(first + 8 - address) << (address - first));
    for (std::uintptr_t at = first + 8; at < end; at += 8)
      touch_cell(at, bits(std::min<std::uintptr_t>(end - at, 8)));
  } else if (!touch_cell(first, bits(size) << (address - first)) && !writes &&
             limits_.uninitialised) {
    report(FindingKind::uninitialised_read,
           "the read at {0} is of memory that nothing was written to since it was allocated at "
           "{1}",
           {pc, heap_.find(address)->allocated_at},
           {allocation_of(*heap_.find(address)), here(pc, "read", "nothing was written there")});
  }
}

// After so many accesses without an event it is time to ask whether they ever end. For plain ones
// nothing is known of the code's registers, so that it must come by the same place and address,
// with memory as it was, as often as a loop may look.
void Execution::check_walk(std::uintptr_t address, std::size_t size, bool writes, bool atomic,
                           const void* pc) {
  if (walk_ == long_walk + 1) {
    alone_.begin();
    looks_ = 0;
  }
  if (walk_ > longest_walk)
    give_up(
        fmt::format("an execution makes more than {} accesses between two steps", longest_walk));
  check_time();
  if (writes) {
    if (!on_own_stack(address)) alone_.note_write(address, size);
    return;
  }
  if (atomic || !alone_.repeats(address ^ reinterpret_cast<std::uintptr_t>(pc))) return;
  if (++looks_ > limits_.looks)
    report(FindingKind::livelock, "the plain read at {0} is repeated for ever: nothing changes",
           {pc});
}

void Execution::check_race(const Cell& cell, const Touch& touch) {
  const Clock& now = graph_.thread(touch.thread).now;
  for (std::uint32_t number = cell.touches; number != 0;) {
    const Touch& other = heap_.touch(number);
    number = other.next;
    if (other.thread == touch.thread || (other.bytes & touch.bytes) == 0 ||
        !(other.writes || touch.writes) || (other.atomic && touch.atomic) ||
        now.count[other.thread] >= other.moment)
      continue;
    if (!known_.empty() && knows(FindingKind::data_race, {touch.pc, other.pc}, "")) continue;
    const auto name = [](const Touch& t) {
      return std::string(t.atomic ? "atomic " : "plain ") + verb(t.writes);
    };
    const auto before = static_cast<std::uint16_t>(other.moment - 1);
    report(FindingKind::data_race,
           "the " + name(touch) + " at {0} by thread " + std::to_string(touch.thread) +
               " and the " + name(other) + " at {1} by thread " + std::to_string(other.thread) +
               " are to the same memory, and neither happens before the other",
           {touch.pc, other.pc},
           {here(touch.pc, name(touch), "races with {1} of thread " + std::to_string(other.thread)),
            {other.thread, before, other.pc, name(other),
             "races with {0} of thread " + std::to_string(touch.thread)}});
  }
}

Moment Execution::here(const void* pc, std::string what, std::string note) const {
  const unsigned thread = cores_.current();
  return {thread, graph_.thread(thread).now.count[thread], pc, std::move(what), std::move(note)};
}

Moment Execution::allocation_of(const Block& block) {
  return {block.allocated_by, block.allocated_after, block.allocated_at, "allocated", ""};
}

Moment Execution::free_of(const Block& block, std::string note) {
  return {block.freed_by, block.freed_after, block.freed_at, "freed", std::move(note)};
}

void Execution::report_unusable(std::uintptr_t eight_bytes, bool writes, bool atomic,
                                const void* pc) {
  const std::string access = std::string(atomic ? "atomic " : "plain ") + verb(writes);
  const std::string what = "the " + access + " at {0} ";
  // The last block that begins before the end of these eight bytes.
  const Block* block = heap_.find(eight_bytes + 7);
  if (block == nullptr || eight_bytes >= block->address + block->size)
    report(FindingKind::out_of_bounds, what + "is outside of every block of the heap", {pc},
           {here(pc, access, "outside of every block")});
  if (block->freed)
    report(FindingKind::use_after_free,
           what + "by thread " + std::to_string(cores_.current()) + " is to memory that thread " +
               std::to_string(block->freed_by) + " freed at {1} (allocated at {2})",
           {pc, block->freed_at, block->allocated_at},
           {allocation_of(*block), free_of(*block, "used later at {0}"),
            here(pc, access, "of memory that was freed at {1}")});
  report(FindingKind::out_of_bounds,
         what + "is past the end of the block of " + std::to_string(block->size) +
             " bytes that was allocated at {1}",
         {pc, block->allocated_at},
         {allocation_of(*block), here(pc, access, "past the end of the block")});
}

void Execution::plain_read(std::uintptr_t address, std::size_t size, const void* pc) {
  if (on_own_stack(address)) return;
  if (!observed()) return note_unwatched();
  note(Look::Kind::read, address, size);
  check_touch(address, size, false, false, pc);
}

void Execution::plain_write(std::uintptr_t address, std::size_t size, const void* pc) {
  if (!observed()) return void(++beats_);
  if (on_own_stack(address)) {
    // Frames come and go at one address, so stacks are not watched; but an atomic object that
    // was there ends with the next write to its place.
    if (!stack_locations_) return;
    for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < address + size; at += 8)
      if (Cell& cell = heap_.cell(at); cell.location != 0) cell.replaced = 0xFF;
    return;
  }
  ++me().effects;
  note(Look::Kind::write, address, size);
  if (phase_ == Phase::endless) alone_.note_write(address, size);
  check_touch(address, size, true, false, pc);
}

void* Execution::allocate(std::size_t size, std::size_t alignment, const void* pc) {
  ++beats_;
  if (phase_ == Phase::ageing) return allocate_unwatched(size, alignment, pc);
  if (!observed()) return Tenant::allocate(size, alignment, pc);
  if (phase_ == Phase::endless) conclude_alone(false, pc);
  alone_.begin();
  ++me().effects;
  const unsigned thread = cores_.current();
  allocates_ = allocates_ || phase_ == Phase::parallel;
  if (failed_at_.size() < limits_.failing_allocations && chosen(pc)) {
    failed_at_.emplace_back(thread, pc);
    ++me().failed_allocations;
    return nullptr;
  }
  void* block = limits_.reuse_memory && heap_.can_reuse(thread, size, alignment) && chosen(pc)
                    ? heap_.reuse(thread, size, alignment, pc)
                    : heap_.allocate(thread, size, alignment, pc);
  if (block == nullptr)
    give_up(fmt::format("a thread allocates more than {} MB", Heap::region_bytes >> 20U));
  note(Look::Kind::allocate, reinterpret_cast<std::uintptr_t>(block), size);
  heap_.find(reinterpret_cast<std::uintptr_t>(block))->allocated_after =
      graph_.thread(thread).now.count[thread];
  // What is there must not depend on the execution before.
  std::memset(block, 0xA5, size);
  return block;
}

void Execution::release(void* pointer, const void* pc) {
  ++beats_;
  const auto address = reinterpret_cast<std::uintptr_t>(pointer);
  if (!heap_.owns(address)) {
    // What was allocated when the code was loaded is there again in the next execution.
    if (program_.module != nullptr && program_.module->owns_global(address)) return;
    return Tenant::release(pointer, pc);
  }
  if (phase_ == Phase::endless) conclude_alone(false, pc);
  alone_.begin();
  note(Look::Kind::release, address, 0);
  const unsigned thread = cores_.current();
  Block* block = heap_.find(address);
  if (block == nullptr || block->address != address)
    return report(FindingKind::invalid_free, "what is freed at {0} is not the beginning of a block",
                  {pc}, {here(pc, "freed", "not the beginning of a block")});
  if (block->freed)
    report(FindingKind::double_free,
           "thread " + std::to_string(thread) + " frees at {0} what thread " +
               std::to_string(block->freed_by) + " freed at {1} (allocated at {2})",
           {pc, block->freed_at, block->allocated_at},
           {allocation_of(*block), free_of(*block, "the first time"),
            here(pc, "freed", "the second time")});
  const Clock& now = graph_.thread(thread).now;
  for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < address + block->size; at += 8) {
    const Cell* cell = heap_.known_cell(at);
    if (cell == nullptr || cell->toucher == thread + 1) continue;
    for (std::uint32_t number = cell->touches; number != 0;) {
      const Touch& touch = heap_.touch(number);
      number = touch.next;
      if (touch.thread == thread || now.count[touch.thread] >= touch.moment) continue;
      report(FindingKind::use_after_free,
             "thread " + std::to_string(thread) + " frees at {0} what thread " +
                 std::to_string(touch.thread) + " still " + (touch.writes ? "writes" : "reads") +
                 " at {1} (allocated at {2}): nothing makes " + "the access happen before",
             {pc, touch.pc, block->allocated_at},
             {allocation_of(*block),
              {touch.thread, static_cast<std::uint16_t>(touch.moment - 1), touch.pc,
               std::string(touch.atomic ? "atomic " : "plain ") + verb(touch.writes),
               "not ordered before the free at {0}"},
              here(pc, "freed", "not ordered after {1}")});
    }
  }
  ++me().effects;
  block->freed_after = now.count[thread];
  heap_.free(*block, thread, pc);
}

std::size_t Execution::block_size(void* pointer) {
  const Block* block = heap_.find(reinterpret_cast<std::uintptr_t>(pointer));
  return block == nullptr ? Tenant::block_size(pointer) : block->size;
}

}  // namespace irt::checker

// NOLINTEND(performance-no-int-to-ptr)
