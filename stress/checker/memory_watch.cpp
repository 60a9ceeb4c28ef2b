#include "stress/checker/memory_watch.hpp"

#include <algorithm>
#include <string>

namespace irt::checker {

namespace {

const char* verb(bool writes) {
  return writes ? "write" : "read";
}

std::string name_of(const Touch& touch) {
  return std::string(touch.atomic ? "atomic " : "plain ") + verb(touch.writes);
}

Moment moment_of(const Touch& touch, std::string note) {
  return {touch.thread, static_cast<std::uint16_t>(touch.moment - 1), touch.pc, name_of(touch),
          std::move(note)};
}

Moment allocation_of(const Block& block) {
  return {block.allocated_by, block.allocated_after, block.allocated_at, "allocated", ""};
}

Moment free_of(const Block& block, std::string note) {
  return {block.freed_by, block.freed_after, block.freed_at, "freed", std::move(note)};
}

/// Who did something after so many events of its own; `threads` and what comes before and after
/// them.
std::string actor(unsigned thread, std::size_t after, unsigned threads) {
  if (thread < threads) return "thread " + std::to_string(thread);
  return after == 0 ? "the code before the threads" : "the code after the threads";
}

}  // namespace

void MemoryWatch::touch(std::uintptr_t address, std::size_t size, bool writes, bool atomic,
                        const void* pc) {
  ++state_.beats;
  if (++state_.walk > Alone::long_walk) alone_.walk(address, size, writes, atomic, pc);
  // Only what threads do at the same time can race.
  const bool shared = state_.phase == Phase::parallel;
  if (!state_.heap.owns(address) && (!shared || virtual_cores::is_of_library(address))) return;
  const unsigned thread = state_.current();
  Touch touch{static_cast<std::uint8_t>(thread), 0, writes, atomic, 0, 0, pc};
  touch.moment = static_cast<std::uint16_t>(state_.graph.thread(thread).now.count[thread] + 1);
  const auto touch_cell = [&](std::uintptr_t at, unsigned bytes) {
    Cell& cell = state_.heap.cell(at);
    if ((bytes & ~cell.usable) != 0) report_unusable(at, writes, atomic, pc);
    if (shared) {
      touch.bytes = static_cast<std::uint8_t>(bytes);
      const bool again = cell.toucher == thread + 1 && cell.moment == touch.moment && !atomic &&
                         (bytes & ~(writes ? cell.written : cell.read)) == 0;
      if (!again) note_touch(cell, touch);
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
             state_.limits.uninitialised) {
    state_.conclusion.report(
        FindingKind::uninitialised_read,
        "the read at {0} is of memory that nothing was written to since it was allocated at "
        "{1}",
        {pc, state_.heap.find(address)->allocated_at},
        {allocation_of(*state_.heap.find(address)), here(pc, "read", "nothing was written there")});
  }
  if (!shared) return;
  if (const unsigned owner = state_.heap.region_of(address); owner != Heap::no_region) {
    if (owner != thread && state_.limits.races) check_allocation(address, touch);
    return;
  }
  if (state_.program.own_threads != 0)
    for (std::uintptr_t at = first; at < end; at += 8) check_frame(at, touch);
}

// Who knows of the thread's events up to the last allocation knows of all.
void MemoryWatch::check_allocation(std::uintptr_t address, const Touch& touch) {
  const unsigned owner = state_.heap.region_of(address);
  const std::uint16_t known = state_.graph.thread(touch.thread).now.count[owner];
  if (known > state_.heap.last_allocation_of(owner)) return;
  const Block* const block = state_.heap.find(address);
  if (block == nullptr || known > block->allocated_after) return;
  if (state_.conclusion.knows({FindingKind::data_race, "", {touch.pc, block->allocated_at}}))
    return;
  state_.conclusion.report(
      FindingKind::data_race,
      "the " + name_of(touch) + " at {0} by thread " + std::to_string(touch.thread) +
          " is to memory that " + actor(owner, block->allocated_after, state_.threads) +
          " allocates at {1}, and nothing makes the allocation happen before",
      {touch.pc, block->allocated_at},
      {allocation_of(*block), here(touch.pc, name_of(touch), "not ordered after {1}")});
}

void MemoryWatch::check_frame(std::uintptr_t address, const Touch& touch) {
  const auto owner = static_cast<unsigned>(state_.owner_of_stack(address));
  if (owner >= state_.threads || owner == touch.thread) return;
  const std::uint16_t known = state_.graph.thread(touch.thread).now.count[owner];
  if (const auto over = frames_.touch(owner, address, known))
    report_use_after_return(touch, owner, *over);
}

void MemoryWatch::leave(std::uintptr_t frame_end, const void* pc) {
  const unsigned thread = state_.current();
  const Frames::Return over{state_.graph.thread(thread).now.count[thread], frame_end, pc};
  while (const auto address = frames_.take_touched(thread, frame_end)) {
    Cell& cell = state_.heap.cell(*address);
    if (const Touch* touch = unordered_touch(cell)) report_use_after_return(*touch, thread, over);
    cell.touches = 0;  // what comes next is another variable, in memory that several have touched
    cell.read = cell.written = 0;
  }
  frames_.leave(thread, over);
}

void MemoryWatch::report_use_after_return(const Touch& touch, unsigned owner,
                                          const Frames::Return& over) {
  state_.conclusion.report(
      FindingKind::use_after_return,
      "the " + name_of(touch) + " at {0} by thread " + std::to_string(touch.thread) +
          " is to a variable of a function of thread " + std::to_string(owner) +
          ", and nothing makes it happen before that function returns at {1}",
      {touch.pc, over.pc},
      {moment_of(touch, "not ordered before the return at {1}"),
       {owner, over.after, over.pc, "returned", "its variables are no more"}});
}

void MemoryWatch::note_touch(Cell& cell, const Touch& touch) {
  const unsigned toucher = touch.thread + 1U;
  if (cell.toucher != toucher && cell.toucher != 0 && state_.limits.races) check_race(cell, touch);
  state_.heap.add_touch(cell, touch);
  if (touch.atomic) return;
  if (cell.moment != touch.moment) cell.read = cell.written = 0;
  cell.moment = touch.moment;
  std::uint8_t& bytes = touch.writes ? cell.written : cell.read;
  bytes = static_cast<std::uint8_t>(bytes | touch.bytes);
}

void MemoryWatch::check_race(const Cell& cell, const Touch& touch) {
  const Clock& now = state_.graph.thread(touch.thread).now;
  for (std::uint32_t number = cell.touches; number != 0;) {
    const Touch& other = state_.heap.touch(number);
    number = other.next;
    if (other.thread == touch.thread || (other.bytes & touch.bytes) == 0 ||
        !(other.writes || touch.writes) || (other.atomic && touch.atomic) ||
        now.count[other.thread] >= other.moment)
      continue;
    if (state_.conclusion.knows({FindingKind::data_race, "", {touch.pc, other.pc}})) continue;
    state_.conclusion.report(
        FindingKind::data_race,
        "the " + name_of(touch) + " at {0} by thread " + std::to_string(touch.thread) +
            " and the " + name_of(other) + " at {1} by thread " + std::to_string(other.thread) +
            " are to the same memory, and neither happens before the other",
        {touch.pc, other.pc},
        {here(touch.pc, name_of(touch), "races with {1} of thread " + std::to_string(other.thread)),
         moment_of(other, "races with {0} of thread " + std::to_string(touch.thread))});
  }
}

std::string MemoryWatch::this_actor() const {
  const unsigned thread = state_.current();
  return actor(thread, state_.graph.thread(thread).now.count[thread], state_.threads);
}

Moment MemoryWatch::here(const void* pc, std::string what, std::string note) const {
  const unsigned thread = state_.current();
  return {thread, state_.graph.thread(thread).now.count[thread], pc, std::move(what),
          std::move(note)};
}

void MemoryWatch::report_unusable(std::uintptr_t eight_bytes, bool writes, bool atomic,
                                  const void* pc) {
  const std::string access = std::string(atomic ? "atomic " : "plain ") + verb(writes);
  const std::string what = "the " + access + " at {0} ";
  // The last block that begins before the end of these eight bytes.
  const Block* block = state_.heap.find(eight_bytes + 7);
  if (block == nullptr || eight_bytes >= block->address + block->size)
    state_.conclusion.report(FindingKind::out_of_bounds,
                             what + "is outside of every block of the heap", {pc},
                             {here(pc, access, "outside of every block")});
  if (block->freed)
    state_.conclusion.report(FindingKind::use_after_free,
                             what + "by " + this_actor() + " is to memory that " +
                                 actor(block->freed_by, block->freed_after, state_.threads) +
                                 " freed at {1} (allocated at {2})",
                             {pc, block->freed_at, block->allocated_at},
                             {allocation_of(*block), free_of(*block, "used later at {0}"),
                              here(pc, access, "of memory that was freed at {1}")});
  state_.conclusion.report(FindingKind::out_of_bounds,
                           what + "is past the end of the block of " + std::to_string(block->size) +
                               " bytes that was allocated at {1}",
                           {pc, block->allocated_at},
                           {allocation_of(*block), here(pc, access, "past the end of the block")});
}

Block& MemoryWatch::free(std::uintptr_t address, const void* pc) {
  Block* block = state_.heap.find(address);
  if (block == nullptr || block->address != address)
    state_.conclusion.report(FindingKind::invalid_free,
                             "what is freed at {0} is not the beginning of a block", {pc},
                             {here(pc, "freed", "not the beginning of a block")});
  if (block->freed)
    state_.conclusion.report(FindingKind::double_free,
                             this_actor() + " frees at {0} what " +
                                 actor(block->freed_by, block->freed_after, state_.threads) +
                                 " freed at {1} (allocated at {2})",
                             {pc, block->freed_at, block->allocated_at},
                             {allocation_of(*block), free_of(*block, "the first time"),
                              here(pc, "freed", "the second time")});
  check_users(*block, pc);
  return *block;
}

const Touch* MemoryWatch::unordered_touch(const Cell& cell) const {
  const unsigned thread = state_.current();
  const Clock& now = state_.graph.thread(thread).now;
  for (std::uint32_t number = cell.touches; number != 0;) {
    const Touch& touch = state_.heap.touch(number);
    if (touch.thread != thread && now.count[touch.thread] < touch.moment) return &touch;
    number = touch.next;
  }
  return nullptr;
}

// Whatever was done to it must happen before.
void MemoryWatch::check_users(const Block& block, const void* pc) {
  for (std::uintptr_t at = block.address & ~std::uintptr_t{7}; at < block.address + block.size;
       at += 8) {
    const Cell* cell = state_.heap.known_cell(at);
    if (cell == nullptr || cell->toucher == state_.current() + 1) continue;
    const Touch* const touch = unordered_touch(*cell);
    if (touch == nullptr) continue;
    state_.conclusion.report(
        FindingKind::use_after_free,
        this_actor() + " frees at {0} what thread " + std::to_string(touch->thread) + " still " +
            (touch->writes ? "writes" : "reads") + " at {1} (allocated at {2}): nothing makes " +
            "the access happen before",
        {pc, touch->pc, block.allocated_at},
        {allocation_of(block), moment_of(*touch, "not ordered before the free at {0}"),
         here(pc, "freed", "not ordered after {1}")});
  }
}

}  // namespace irt::checker
