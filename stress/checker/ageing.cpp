// Ageing, see ageing.hpp: the part of an execution before anything is watched.

#include "stress/checker/ageing.hpp"

#include <cstring>
#include <fmt/format.h>

#include "stress/checker/execution.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::checker {

namespace {

/// A queue whose memory grows with each pair is not aged further: every execution would have to
/// give all of it back.
constexpr std::size_t most_blocks = 20'000;
/// A call that makes more accesses to memory is taken for one that does not return.
constexpr std::uint64_t longest_call = 10'000'000;

}  // namespace

void Execution::begin_aged() {
  AgedMemory& memory = *program_.aged;
  if (memory.what != program_.aged_what || memory.age > program_.age)
    memory = {.what = program_.aged_what};
  if (memory.age != 0) {
    heap_.restore(memory.heap);
    if (program_.module != nullptr) program_.module->restore(memory.globals);
  }
  if (memory.age == program_.age) return;
  if (program_.module != nullptr && !program_.module->unseen_calls().empty()) {
    // It may keep something elsewhere, which no copy of this memory puts back.
    incomplete_ = "a queue that calls compiled code is not aged";
    outcome_ = Outcome::cut;
    return;
  }
  phase_ = Phase::ageing;
  std::uint64_t n = memory.age;
  const std::function<void()> work = [this, &n] {
    for (; n < program_.age; ++n) {
      if (n % 16 == 0 && deadline_.passed()) {
        out_of_time_ = true;
        return;
      }
      walk_ = 0;
      program_.grow_older(n);
      if (n % 256 == 0 && heap_.blocks().size() > most_blocks)
        give_up(
            fmt::format("a queue whose memory grows with every push is not aged further than "
                        "{} pairs",
                        n + 1));
    }
  };
  run_main(work);
  states_[main_] = ThreadState{};
  walk_ = 0;
  if (outcome_ != Outcome::complete) {
    memory = {};
    return;
  }
  if (out_of_time_) outcome_ = Outcome::cut;
  memory.age = n;
  heap_.settle();
  memory.heap = heap_.image();
  if (program_.module != nullptr) memory.globals = program_.module->image();
}

void Execution::note_unwatched() {
  ++beats_;
  if (phase_ == Phase::ageing && ++walk_ > longest_call)
    give_up(fmt::format("a call while the queue is aged makes more than {} accesses to memory",
                        longest_call));
}

// As malloc does it: what was freed last comes back first.
void* Execution::allocate_unwatched(std::size_t size, std::size_t alignment, const void* pc) {
  void* block = heap_.can_reuse(main_, size, alignment)
                    ? heap_.reuse(main_, size, alignment, pc)
                    : heap_.allocate(main_, size, alignment, pc);
  if (block == nullptr)
    give_up(fmt::format("ageing the queue takes more than {} MB", Heap::region_bytes >> 20U));
  std::memset(block, 0xA5, size);
  return block;
}

Heap::Image Heap::image() const {
  Image image{blocks_, regions_, generation_, {}, {}};
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const std::uintptr_t begin = base_ + i * region_bytes;
    const auto* bytes = reinterpret_cast<const char*>(begin);
    const std::size_t used = (regions_[i].next - begin + 7) / 8 * 8;
    const Cell* cells = cells_ + (begin - base_) / 8;
    image.bytes.emplace_back(bytes, bytes + used);
    image.cells.emplace_back(cells, cells + used / 8);
  }
  return image;
}

void Heap::restore(const Image& image) {
  blocks_ = image.blocks;
  regions_ = image.regions;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const std::uintptr_t begin = base_ + i * region_bytes;
    std::memcpy(reinterpret_cast<void*>(begin), image.bytes[i].data(), image.bytes[i].size());
    Cell* cells = cells_ + (begin - base_) / 8;
    for (const Cell& cell : image.cells[i]) {
      *cells = cell;
      // What was not known then is not known now.
      cells->generation = cell.generation == image.generation ? generation_ : 0;
      ++cells;
    }
  }
}

void Heap::settle() {
  for (const Block& block : blocks_) {
    if (block.freed) continue;
    for (std::uintptr_t at = block.address; at < block.address + block.size; at += 8)
      cells_[(at - base_) / 8].initialised = 0xFF;
  }
}

}  // namespace irt::checker

// NOLINTEND(performance-no-int-to-ptr)
