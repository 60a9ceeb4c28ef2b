/// Atomic operations whose numbers are known, compiled to be counted.
#pragma once

#include <atomic>
#include <cstdint>

namespace irt {

/// `good` compare-and-swaps that succeed and `bad` ones that do not.
void compare_and_swap(std::atomic<std::uint64_t>& word, unsigned good, unsigned bad);

/// The same with 16 bytes; returns whether each did what it should.
bool compare_and_swap_pairs(unsigned good, unsigned bad);

/// Raises `word` by one `times` times, by compare-and-swap; returns how many it took.
std::uint64_t raise(std::atomic<std::uint64_t>& word, unsigned times);

/// One of each other operation on `word`, which is 0b1100 before; returns what they saw and left,
/// added up: 5 modifications, 1 load, 2 stores.
std::uint64_t modify(std::atomic<std::uint64_t>& word);

}  // namespace irt
