#include "tests/bench/counted/probe.hpp"

namespace irt {

void compare_and_swap(std::atomic<std::uint64_t>& word, unsigned good, unsigned bad) {
  for (unsigned i = 0; i < good; ++i) {
    std::uint64_t expected = word.load();
    word.compare_exchange_strong(expected, expected + 1);
  }
  for (unsigned i = 0; i < bad; ++i) {
    std::uint64_t expected = ~std::uint64_t{0};
    word.compare_exchange_strong(expected, 0);
  }
}

bool compare_and_swap_pairs(unsigned good, unsigned bad) {
  __extension__ using Pair = unsigned __int128;
  alignas(16) Pair pair = Pair{1} << 100U;
  bool right = true;
  for (unsigned i = 0; i < good; ++i)
    right &= __sync_bool_compare_and_swap(&pair, (Pair{1} << 100U) + i, (Pair{1} << 100U) + i + 1);
  for (unsigned i = 0; i < bad; ++i)
    right &= !__sync_bool_compare_and_swap(&pair, Pair{5}, Pair{6});
  return right && pair == (Pair{1} << 100U) + good;
}

std::uint64_t raise(std::atomic<std::uint64_t>& word, unsigned times) {
  std::uint64_t tries = 0;
  for (unsigned i = 0; i < times; ++i) {
    std::uint64_t seen = word.load();
    do ++tries;
    while (!word.compare_exchange_weak(seen, seen + 1));
  }
  return tries;
}

std::uint64_t modify(std::atomic<std::uint64_t>& word) {
  std::uint64_t sum = word.fetch_add(1);  // 12, leaves 13
  sum += word.fetch_sub(2);               // 13, leaves 11
  sum += word.fetch_or(4);                // 11, leaves 15
  sum += word.fetch_and(6);               // 15, leaves 6
  sum += word.exchange(9);                // 6, leaves 9
  word.store(word.load() + 1);            // leaves 10
  word.store(20, std::memory_order_release);
  return sum;
}

}  // namespace irt
