#include "bench/many_core/machine/heap.hpp"

#include <algorithm>
#include <stdexcept>
#include <sys/mman.h>

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::many_core {

namespace {

// Blocks lie at the same addresses in every run.
constexpr std::uintptr_t heap_address = 0x200000000000;

// The word before a block.
struct Header {
  std::uint64_t pc : 48;
  std::uint64_t kind : 16;
};
static_assert(sizeof(Header) == 8);

Header& header_of(const void* block) {
  return *reinterpret_cast<Header*>(reinterpret_cast<std::uintptr_t>(block) - sizeof(Header));
}

}  // namespace

Heap::Heap(unsigned threads) : bytes_(threads * arena_bytes), arenas_(threads), kinds_{Kind{0, 0}} {
  void* memory = mmap(reinterpret_cast<void*>(heap_address), bytes_, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED_NOREPLACE, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("no room for the heap of simulated threads");
  begin_ = heap_address;
  for (unsigned i = 0; i < threads; ++i) {
    // The first line of an arena is its lock. Blocks begin at different lines of a page in each,
    // or those of all arenas would compete for the same sets of the host's caches.
    arenas_[i].begin = arenas_[i].used = begin_ + i * arena_bytes;
    arenas_[i].next = arenas_[i].begin + 64 + i % 61 * 64;
  }
}

Heap::~Heap() {
  munmap(reinterpret_cast<void*>(begin_), bytes_);
}

// The distance between blocks is glibc's: a word of bookkeeping, multiples of 16.
std::uint16_t Heap::kind_of(std::size_t size, std::size_t alignment) {
  const std::size_t space = std::max<std::size_t>((size + 8 + 15) / 16 * 16, 32);
  const bool small = space < 16 * small_kinds_.size() && alignment <= 16;
  if (small && small_kinds_[space / 16] != 0) return small_kinds_[space / 16];
  const auto [found, fresh] = kind_numbers_.try_emplace(
      {space, std::max<std::size_t>(alignment, 16)}, static_cast<std::uint16_t>(kinds_.size()));
  if (fresh) kinds_.push_back({space, std::max<std::size_t>(alignment, 16)});
  if (small) small_kinds_[space / 16] = found->second;
  return found->second;
}

Heap::Bin& Heap::bin(unsigned thread, std::uint16_t kind) {
  std::vector<Bin>& bins = arenas_[thread].bins;
  if (bins.size() <= kind) bins.resize(kinds_.size());
  return bins[kind];
}

void* Heap::carve(Arena& arena, std::uint16_t kind) {
  const auto [space, alignment] = kinds_[kind];
  const std::uintptr_t block = (arena.next + 8 + alignment - 1) / alignment * alignment;
  if (block + space > arena.begin + arena_bytes) return nullptr;
  arena.next = block + space - 8;
  arena.blocks.push_back(block);
  return reinterpret_cast<void*>(block);
}

void* Heap::allocate(unsigned thread, std::size_t size, std::size_t alignment, const void* pc,
                     Traffic& traffic) {
  if (size >= arena_bytes) return nullptr;
  const std::uint16_t kind = kind_of(size, alignment);
  Bin& mine = bin(thread, kind);
  void* block = nullptr;
  if (!mine.cached.empty()) {
    block = mine.cached.back();
    mine.cached.pop_back();
  } else if (!mine.returned.empty()) {
    traffic.locked = arenas_[thread].begin;
    block = mine.returned.back();
    traffic.linked = reinterpret_cast<std::uintptr_t>(block);
    mine.returned.pop_back();
  } else {
    block = carve(arenas_[thread], kind);
    if (block == nullptr) return nullptr;
  }
  header_of(block) = {reinterpret_cast<std::uintptr_t>(pc) & ((std::uint64_t{1} << 48U) - 1), kind};
  return block;
}

void Heap::release(unsigned thread, void* block, Traffic& traffic) {
  const auto kind = static_cast<std::uint16_t>(header_of(block).kind);
  Bin& mine = bin(thread, kind);
  if (mine.cached.size() < tcache_blocks) {
    mine.cached.push_back(block);
    return;
  }
  const unsigned home = arena_of(reinterpret_cast<std::uintptr_t>(block));
  traffic.locked = arenas_[home].begin;
  bin(home, kind).returned.push_back(block);
}

std::size_t Heap::size_of(const void* block) const {
  return kinds_[header_of(block).kind].space - 8;
}

void Heap::mark_used() {
  for (Arena& arena : arenas_) arena.used = arena.next;
}

Heap::Block Heap::describe(std::uintptr_t address) const {
  if (!owns(address)) return {};
  const Arena& arena = arenas_[arena_of(address)];
  const auto after = std::ranges::upper_bound(arena.blocks, address);
  if (after == arena.blocks.begin()) return {};
  const std::uintptr_t begin = *(after - 1);
  const void* block = reinterpret_cast<const void*>(begin);
  return {begin, size_of(block),
          reinterpret_cast<const void*>(static_cast<std::uintptr_t>(header_of(block).pc))};
}

}  // namespace irt::many_core
// NOLINTEND(performance-no-int-to-ptr)
