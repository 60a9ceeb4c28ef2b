#include "stress/checker/leaks.hpp"

#include <algorithm>
#include <vector>

namespace irt::checker {

namespace {

/// Calls `found` for each block that is not freed and that a word from `range` may point into.
template <class Found>
void each_pointed_at(Heap& heap, virtual_cores::Range range, Found found) {
  constexpr std::uint64_t address_bits = (std::uint64_t{1} << 48U) - 1;
  for (std::uintptr_t at = (range.begin + 7) & ~std::uintptr_t{7}; at + 8 <= range.end; at += 8) {
    const auto word = static_cast<std::uint64_t>(virtual_cores::read_memory(at, 8));
    // As it is, with marks above it, or shifted up by marks below it.
    for (const std::uint64_t address : {word, word & address_bits, word >> 16U}) {
      Block* block = heap.find(address);
      // One past the end counts: that is how some containers point at an empty block.
      if (block == nullptr || block->freed || address > block->address + block->size) continue;
      found(*block);
      break;
    }
  }
}

}  // namespace

std::vector<const Block*> lost_blocks(Heap& heap, std::span<const virtual_cores::Range> roots) {
  const std::vector<Block>& blocks = heap.blocks();
  if (std::ranges::all_of(blocks, &Block::freed)) return {};
  std::vector<bool> kept(blocks.size());
  std::vector<const Block*> open;
  const auto keep = [&](const Block& block) {
    const auto number = static_cast<std::size_t>(&block - blocks.data());
    if (kept[number]) return;
    kept[number] = true;
    open.push_back(&block);
  };
  const auto follow = [&] {
    while (!open.empty()) {
      const Block* block = open.back();
      open.pop_back();
      each_pointed_at(heap, {block->address, block->address + block->size}, keep);
    }
  };
  for (const virtual_cores::Range& root : roots) each_pointed_at(heap, root, keep);
  follow();
  const auto is_lost = [&](std::size_t i) { return !blocks[i].freed && !kept[i]; };
  std::vector<bool> led_to(blocks.size());
  const Block* first = nullptr;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!is_lost(i)) continue;
    if (first == nullptr) first = &blocks[i];
    each_pointed_at(heap, {blocks[i].address, blocks[i].address + blocks[i].size},
                    [&](const Block& to) {
                      if (&to != &blocks[i])
                        led_to[static_cast<std::size_t>(&to - blocks.data())] = true;
                    });
  }
  std::vector<const Block*> lost;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (is_lost(i) && !led_to[i]) lost.push_back(&blocks[i]);
  if (lost.empty() && first != nullptr) lost.push_back(first);
  return lost;
}

}  // namespace irt::checker
