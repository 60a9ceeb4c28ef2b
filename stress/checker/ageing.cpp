// Ageing, see ageing.hpp: the part of an execution before anything is watched.

#include "stress/checker/ageing.hpp"

#include <cstring>
#include <fmt/format.h>

#include "stress/checker/execution_state.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::checker {

namespace {

/// A queue whose memory grows with each pair is not aged further: every execution would have to
/// give all of it back.
constexpr std::size_t most_blocks = 20'000;

}  // namespace

void age(ExecutionState& state) {
  Conclusion& conclusion = state.conclusion;
  const Program& program = state.program;
  AgedMemory& memory = *program.aged;
  if (memory.what != program.aged_what || memory.age > program.age)
    memory = {.what = program.aged_what};
  if (memory.age != 0) {
    state.heap.restore(memory.heap);
    if (program.module != nullptr) program.module->restore(memory.globals);
  }
  if (memory.age == program.age) return;
  if (program.module != nullptr && !program.module->unseen_calls().empty()) {
    // It may keep something elsewhere, which no copy of this memory puts back.
    conclusion.note_incomplete("a queue that calls compiled code is not aged");
    return conclusion.end(Outcome::cut);
  }
  state.phase = Phase::ageing;
  std::uint64_t n = memory.age;
  const std::function<void()> work = [&] {
    for (; n < program.age; ++n) {
      if (n % 16 == 0 && conclusion.deadline().passed()) return conclusion.run_out_of_time();
      state.walk = 0;
      program.grow_older(n);
      if (n % 256 == 0 && state.heap.blocks().size() > most_blocks)
        conclusion.give_up(
            fmt::format("a queue whose memory grows with every push is not aged further than "
                        "{} pairs",
                        n + 1));
    }
  };
  state.run_main(work);
  state.walk = 0;
  if (conclusion.outcome() != Outcome::complete) {
    memory = {};
    return;
  }
  if (conclusion.out_of_time()) conclusion.end(Outcome::cut);
  memory.age = n;
  state.heap.settle();
  memory.heap = state.heap.image();
  if (program.module != nullptr) memory.globals = program.module->image();
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
