#include "stress/checker/heap.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <sys/mman.h>

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::checker {

namespace {

constexpr std::uintptr_t heap_address = 0x200000000000;
// Between blocks, so that a step past the end of one does not land in another.
constexpr std::size_t gap_bytes = 32;

void* map(std::uintptr_t address, std::size_t bytes) {
  const int place = address == 0 ? 0 : MAP_FIXED_NOREPLACE;
  void* memory = mmap(reinterpret_cast<void*>(address), bytes, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | place, -1, 0);
  if (memory == MAP_FAILED)
    throw std::runtime_error(std::string("checker: cannot reserve address space: ") +
                             std::strerror(errno));
  return memory;
}

}  // namespace

Heap::Heap(unsigned threads) : regions_(threads) {
  bytes_ = threads * region_bytes;
  base_ = reinterpret_cast<std::uintptr_t>(map(heap_address, bytes_));
  cells_ = static_cast<Cell*>(map(0, bytes_ / 8 * sizeof(Cell)));
  clear();
}

Heap::~Heap() {
  munmap(reinterpret_cast<void*>(base_), bytes_);
  munmap(cells_, bytes_ / 8 * sizeof(Cell));
}

void Heap::clear() {
  ++generation_;
  blocks_.clear();
  touches_.clear();
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    regions_[i].next = base_ + i * region_bytes + 64;
    regions_[i].last_allocation = 0;
    regions_[i].blocks.clear();
    regions_[i].freed.clear();
  }
}

std::size_t Heap::last_freed(unsigned thread, std::size_t size, std::size_t alignment) const {
  const std::vector<std::uint32_t>& freed = regions_[thread].freed;
  const auto same = std::find_if(freed.rbegin(), freed.rend(), [&](std::uint32_t number) {
    const Block& block = blocks_[number - 1];
    return block.size == size && block.address % alignment == 0;
  });
  return same == freed.rend() ? freed.size() : static_cast<std::size_t>(freed.rend() - same) - 1;
}

void* Heap::reuse(unsigned thread, std::size_t size, std::size_t alignment, const void* pc) {
  std::vector<std::uint32_t>& freed = regions_[thread].freed;
  const auto last =
      freed.begin() + static_cast<std::ptrdiff_t>(last_freed(thread, size, alignment));
  Block& again = block(*last);
  freed.erase(last);
  again.freed = false;
  again.allocated_at = pc;
  begin_cells(again);
  return reinterpret_cast<void*>(again.address);
}

void* Heap::allocate(unsigned thread, std::size_t size, std::size_t alignment, const void* pc) {
  Region& region = regions_[thread];
  alignment = std::max<std::size_t>(alignment, 16);
  const std::uintptr_t address = (region.next + alignment - 1) / alignment * alignment;
  const std::size_t begin = (address - base_) - thread * region_bytes;
  if (size > region_bytes || begin + size + gap_bytes > region_bytes) return nullptr;
  region.next = address + size + gap_bytes;
  blocks_.push_back({address, size, pc, nullptr, static_cast<std::uint8_t>(thread), 0, false});
  region.blocks.push_back(static_cast<std::uint32_t>(blocks_.size()));
  begin_cells(blocks_.back());
  return reinterpret_cast<void*>(address);
}

void Heap::begin_cells(const Block& block) {
  for (std::uintptr_t at = block.address; at < block.address + block.size; at += 8) {
    Cell& cell = cells_[(at - base_) / 8];
    cell = Cell{};
    cell.generation = generation_;
    const std::uintptr_t left = block.address + block.size - at;
    cell.usable = static_cast<std::uint8_t>(left < 8 ? (1U << left) - 1 : 0xFFU);
  }
}

void Heap::free(Block& block, unsigned thread, const void* pc) {
  block.freed = true;
  block.freed_by = static_cast<std::uint8_t>(thread);
  block.freed_at = pc;
  for (std::uintptr_t at = block.address; at < block.address + block.size; at += 8)
    cells_[(at - base_) / 8].usable = 0;
  // Only the allocating thread's own blocks come back to it: others' would need an order.
  if (block.allocated_by == thread)
    regions_[thread].freed.push_back(static_cast<std::uint32_t>(&block - blocks_.data()) + 1);
}

void Heap::date(std::uintptr_t address, std::uint16_t after) {
  find(address)->allocated_after = after;
  regions_[region_of(address)].last_allocation = after;
}

Block* Heap::find(std::uintptr_t address) {
  if (!owns(address)) return nullptr;
  const std::vector<std::uint32_t>& numbers = regions_[(address - base_) / region_bytes].blocks;
  const auto after = std::ranges::upper_bound(
      numbers, address, {}, [this](std::uint32_t number) { return block(number).address; });
  return after == numbers.begin() ? nullptr : &block(*std::prev(after));
}

Heap::Page Heap::find_page(std::uintptr_t number) {
  std::unique_ptr<Cell[]>& cells = other_cells_[number];
  if (cells == nullptr) cells = std::make_unique<Cell[]>(page_bytes / 8);
  return {number, cells.get()};
}

Cell& Heap::other_cell(std::uintptr_t address) {
  const bool mine = owns(address);  // then outside of every block
  const std::uintptr_t number = address / page_bytes;
  Page& page = pages_[number % pages_.size()];
  if (!mine && page.number != number) page = find_page(number);
  Cell& cell = mine ? cells_[(address - base_) / 8] : page.cells[address % page_bytes / 8];
  if (cell.generation == generation_) return cell;
  cell = Cell{};
  cell.generation = generation_;
  if (!mine) cell.initialised = cell.usable = 0xFF;
  return cell;
}

void Heap::add_touch(Cell& cell, const Touch& touch) {
  const auto toucher = static_cast<std::uint8_t>(touch.thread + 1);
  if (cell.toucher != toucher) cell.toucher = cell.toucher == 0 ? toucher : several_touchers;
  for (std::uint32_t* link = &cell.touches; *link != 0;) {
    Touch& old = touches_[*link - 1];
    if (old.thread == touch.thread && old.writes == touch.writes && old.atomic == touch.atomic &&
        (old.bytes & ~touch.bytes) == 0) {
      const std::uint32_t next = old.next;
      old = touch;
      old.next = next;
      return;
    }
    link = &old.next;
  }
  touches_.push_back(touch);
  touches_.back().next = cell.touches;
  cell.touches = static_cast<std::uint32_t>(touches_.size());
}

}  // namespace irt::checker

// NOLINTEND(performance-no-int-to-ptr)
