/// Memory as the checker sees it: a heap of its own, and for each eight bytes who touched them.
///
/// Each thread allocates from a region of its own, at addresses that depend only on what that
/// thread did before: the same program text gets the same addresses whatever the others do. A freed
/// block is used again within an execution only on demand: `reuse` gives a thread the block of that
/// size that it freed last.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "stress/checker/clock.hpp"

namespace irt::checker {

/// A block of the heap.
struct Block {
  std::uintptr_t address = 0;
  std::size_t size = 0;
  const void* allocated_at = nullptr;
  const void* freed_at = nullptr;
  std::uint8_t allocated_by = 0;
  std::uint8_t freed_by = 0;
  bool freed = false;
  std::uint16_t allocated_after = 0;  ///< so many events of `allocated_by`
  std::uint16_t freed_after = 0;      ///< so many events of `freed_by`
};

/// One thread's last access of one kind to some of eight bytes.
struct Touch {
  std::uint8_t thread;
  std::uint8_t bytes;  ///< a bit for each
  bool writes;
  bool atomic;
  std::uint16_t moment;  ///< happens before whoever has at least this many of the thread's events
  std::uint32_t next;
  const void* pc;
};

/// `Cell::toucher` when there are more.
inline constexpr std::uint8_t several_touchers = 0xFF;

/// What is known about eight bytes.
struct Cell {
  std::uint32_t generation = 0;
  std::uint32_t touches = 0;   ///< plus one; 0 is none
  std::uint32_t location = 0;  ///< plus one; 0 is none
  std::uint8_t initialised = 0;
  std::uint8_t replaced = 0;  ///< bytes that a plain write changed after the location's stores
  std::uint8_t usable = 0;    ///< bytes inside a block that is not freed, or outside of the heap
  std::uint8_t toucher = 0;   ///< the only thread that touched it, plus one; 0: none
  // What it has touched at one moment and need not be noted again.
  std::uint16_t moment = 0;
  std::uint8_t read = 0;     ///< bytes
  std::uint8_t written = 0;  ///< likewise
};

class Heap {
 public:
  /// What a thread may allocate in an execution, freed blocks and gaps between blocks included.
  static constexpr std::size_t region_bytes = std::size_t{64} << 20U;

  /// Everything in it and about it, at one moment between executions.
  struct Image;

  explicit Heap(unsigned threads);
  Heap(const Heap&) = delete;
  Heap& operator=(const Heap&) = delete;
  ~Heap();

  /// Forgets everything; memory keeps its contents, which count as uninitialised.
  void clear();

  [[nodiscard]] Image image() const;
  /// Puts back what `image` holds of a heap of as many threads; call `clear` before.
  void restore(const Image& image);
  /// From now on all that is not freed counts as written.
  void settle();

  /// Null when the thread's region is full.
  void* allocate(unsigned thread, std::size_t size, std::size_t alignment, const void* pc);
  /// Whether the thread has freed a block of that size.
  [[nodiscard]] bool can_reuse(unsigned thread, std::size_t size, std::size_t alignment) const {
    return last_freed(thread, size, alignment) != regions_[thread].freed.size();
  }
  /// The block of that size that it freed last; there must be one.
  void* reuse(unsigned thread, std::size_t size, std::size_t alignment, const void* pc);
  void free(Block& block, unsigned thread, const void* pc);
  /// The block at `address` was allocated after so many events of its thread.
  void date(std::uintptr_t address, std::uint16_t after);
  /// After how many of its events `thread` has allocated last.
  [[nodiscard]] std::uint16_t last_allocation_of(unsigned thread) const {
    return regions_[thread].last_allocation;
  }

  [[nodiscard]] bool owns(std::uintptr_t address) const { return address - base_ < bytes_; }
  /// Whose region `address` is in; `no_region` if it is in none.
  [[nodiscard]] unsigned region_of(std::uintptr_t address) const {
    return owns(address) ? static_cast<unsigned>((address - base_) / region_bytes) : no_region;
  }
  static constexpr unsigned no_region = ~0U;
  /// The address in the region of `to` that corresponds to one in that of `from`.
  [[nodiscard]] static std::uintptr_t twin(std::uintptr_t address, unsigned from, unsigned to) {
    return address - from * region_bytes + to * region_bytes;
  }
  /// The block that `address` is in or, if in none, the one before it in the same region; null if
  /// there is none.
  Block* find(std::uintptr_t address);
  /// What is known about the eight bytes at `address` / 8 * 8.
  Cell& cell(std::uintptr_t address) {
    Cell* const known = known_cell(address);
    return known != nullptr ? *known : other_cell(address);
  }
  /// The same for memory of the heap, or null if nothing is known.
  Cell* known_cell(std::uintptr_t address) {
    if (!owns(address)) return nullptr;
    Cell& known = cells_[(address - base_) / 8];
    return known.generation == generation_ ? &known : nullptr;
  }

  /// The only thread that touched the eight bytes at `address` / 8 * 8, plus one; 0: none.
  [[nodiscard]] std::uint8_t toucher(std::uintptr_t address) { return cell(address).toucher; }

  [[nodiscard]] const Touch& touch(std::uint32_t number) const { return touches_[number - 1]; }
  /// Notes a touch. It takes the place of the thread's earlier ones of the kind that it covers.
  void add_touch(Cell& cell, const Touch& touch);

  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }

 private:
  struct Region {
    std::uintptr_t next = 0;
    std::uint16_t last_allocation = 0;  ///< after so many events
    std::vector<std::uint32_t> blocks;  ///< in the order of their addresses
    std::vector<std::uint32_t> freed;   ///< in the order in which they were freed
  };

  /// Of memory outside of the heap, globals, stacks and thread_locals, with its cells.
  static constexpr std::uintptr_t page_bytes = 4096;
  struct Page {
    std::uintptr_t number = ~std::uintptr_t{0};
    Cell* cells = nullptr;
  };
  Page find_page(std::uintptr_t number);

  Block& block(std::uint32_t number) { return blocks_[number - 1]; }
  /// Its place among what the thread has freed; behind the last if there is none.
  [[nodiscard]] std::size_t last_freed(unsigned thread, std::size_t size,
                                       std::size_t alignment) const;
  /// One that nothing is known of, or of memory outside of the heap.
  Cell& other_cell(std::uintptr_t address);
  void begin_cells(const Block& block);

  std::uintptr_t base_ = 0;
  std::size_t bytes_ = 0;
  std::vector<Region> regions_;
  std::vector<Block> blocks_;
  Cell* cells_ = nullptr;  ///< of the heap, one per eight bytes
  std::unordered_map<std::uintptr_t, std::unique_ptr<Cell[]>> other_cells_;  ///< by page
  std::array<Page, 64> pages_{};  ///< of these, those used last
  std::vector<Touch> touches_;
  std::uint32_t generation_ = 1;
};

struct Heap::Image {
  std::vector<Block> blocks;
  std::vector<Region> regions;
  std::uint32_t generation = 0;
  std::vector<std::vector<char>> bytes;  ///< by region
  std::vector<std::vector<Cell>> cells;  ///< likewise
};

}  // namespace irt::checker
