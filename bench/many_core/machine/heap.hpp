/// The allocator of simulated threads, laid out and reused as glibc's (2.36).
///
/// A block follows a word of bookkeeping, blocks lie 16 bytes apart at least, and each thread has
/// an arena of its own that grows upwards. A thread keeps up to seven freed blocks of a size for
/// itself (the tcache), last in, first out; more go back to the arena they came from, under its
/// lock, and are taken from there by its owner when it has none left. What that costs in cache
/// lines the machine charges (`Heap::Traffic`).
///
/// Not modelled: splitting and merging of blocks, returning memory to the system, page faults.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace irt::many_core {

class Heap {
 public:
  explicit Heap(unsigned threads);
  Heap(const Heap&) = delete;
  Heap& operator=(const Heap&) = delete;
  ~Heap();

  /// What an allocation or release does to memory that threads share.
  struct Traffic {
    std::uintptr_t locked = 0;  ///< the lock of an arena that was taken, or 0
    std::uintptr_t linked = 0;  ///< a free block that was read, or 0
  };

  /// Null when the address space is used up. `pc` is remembered for `describe`.
  void* allocate(unsigned thread, std::size_t size, std::size_t alignment, const void* pc,
                 Traffic& traffic);
  void release(unsigned thread, void* block, Traffic& traffic);
  [[nodiscard]] std::size_t size_of(const void* block) const;

  [[nodiscard]] bool owns(std::uintptr_t address) const { return address - begin_ < bytes_; }
  /// Whose arena `address` is in.
  [[nodiscard]] unsigned arena_of(std::uintptr_t address) const {
    return static_cast<unsigned>((address - begin_) / arena_bytes);
  }
  /// Whether `address` was never part of a block before `mark_used`.
  [[nodiscard]] bool is_fresh(std::uintptr_t address) const {
    return address >= arenas_[arena_of(address)].used;
  }
  /// All that was allocated so far is no longer fresh.
  void mark_used();

  struct Block {
    std::uintptr_t begin = 0;  ///< 0: the address is in no block
    std::size_t size = 0;
    const void* allocated_at = nullptr;
  };
  /// The block that `address` is in; slow.
  [[nodiscard]] Block describe(std::uintptr_t address) const;

 private:
  static constexpr std::size_t arena_bytes = std::size_t{4} << 30U;
  static constexpr std::size_t tcache_blocks = 7;

  // Blocks that can take each other's place.
  struct Kind {
    std::size_t space;  // from one block to the next
    std::size_t alignment;
  };
  struct Bin {
    std::vector<void*> cached;    // by the thread whose arena this is
    std::vector<void*> returned;  // what its tcache had no room for, and what others returned
  };
  struct Arena {
    std::uintptr_t begin = 0, next = 0, used = 0;
    std::vector<Bin> bins;               // by kind
    std::vector<std::uintptr_t> blocks;  // ascending
  };

  std::uint16_t kind_of(std::size_t size, std::size_t alignment);
  Bin& bin(unsigned thread, std::uint16_t kind);
  void* carve(Arena& arena, std::uint16_t kind);

  std::uintptr_t begin_ = 0;
  std::size_t bytes_ = 0;
  std::vector<Arena> arenas_;
  std::vector<Kind> kinds_;
  std::map<std::pair<std::size_t, std::size_t>, std::uint16_t> kind_numbers_;
  std::array<std::uint16_t, 64> small_kinds_{};  // by space / 16; 0: not there yet
};

}  // namespace irt::many_core
