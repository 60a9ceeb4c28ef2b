#include "stress/checker/diary.hpp"

#include <algorithm>
#include <bit>

namespace irt::checker {

std::uint64_t masked_word(std::uintptr_t address, std::uint8_t bytes) {
  const auto first = static_cast<unsigned>(std::countr_zero(bytes));
  const auto count = static_cast<unsigned>(std::bit_width(bytes)) - first;
  if (count == 8) return static_cast<std::uint64_t>(virtual_cores::read_memory(address, 8));
  std::uint64_t word = 0;
  for (unsigned i = 0; i < count; ++i)
    word |= static_cast<std::uint64_t>(virtual_cores::read_memory(address + first + i, 1))
            << 8 * (first + i);
  return word;
}

void Diary::clear() {
  for (std::vector<Look>& looks : looks_) looks.clear();
  std::ranges::fill(settled_, 0);
}

void Diary::note(Look::Kind kind, unsigned thread, std::size_t moment, std::uintptr_t address,
                 std::size_t size) {
  constexpr std::size_t most = 1'000'000;
  if (looks_[thread].size() + size / 8 > most)
    return note_peculiar("a thread looks at more memory than is kept in mind");
  const std::uintptr_t end = address + size;
  for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < end; at += 8) {
    const std::uintptr_t from = std::max(at, address);
    const std::uintptr_t to = std::min(at + 8, end);
    const auto bytes = static_cast<std::uint8_t>(((1U << (to - from)) - 1) << (from - at));
    looks_[thread].push_back(
        {kind, bytes, static_cast<std::uint16_t>(moment), at, masked_word(at, bytes), 0});
  }
}

void Diary::take_in(unsigned thread) {
  std::vector<Look>& looks = looks_[thread];
  for (std::size_t& i = settled_[thread]; i < looks.size(); ++i)
    if (looks[i].kind == Look::Kind::write)
      looks[i].left = masked_word(looks[i].address, looks[i].bytes);
}

}  // namespace irt::checker
