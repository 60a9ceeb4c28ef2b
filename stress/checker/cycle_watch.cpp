#include "stress/checker/cycle_watch.hpp"

#include <algorithm>
#include <cstring>

namespace irt::checker {

void CycleWatch::begin() {
  if (!at_begin_.empty()) at_begin_.clear();  // which is work even where there is nothing
  if (!at_mark_.empty()) at_mark_.clear();
  mark_ = steps_ = 0;
  power_ = 1;
}

std::uint64_t CycleWatch::word_at(std::uintptr_t address) {
  std::uint64_t word = 0;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): memory is known by its address here
  std::memcpy(&word, reinterpret_cast<const void*>(address), sizeof word);
  return word;
}

void CycleWatch::note_write(std::uintptr_t address, std::size_t size) {
  for (std::uintptr_t at = address & ~std::uintptr_t{7}; at < address + size; at += 8) {
    const std::uint64_t word = word_at(at);
    at_begin_.try_emplace(at, word);
    at_mark_.try_emplace(at, word);
  }
}

bool CycleWatch::repeats(std::uint64_t state) {
  ++steps_;
  if (steps_ > 1 && state == mark_ && std::ranges::all_of(at_mark_, [](const auto& word) {
        return word_at(word.first) == word.second;
      }))
    return true;
  if (steps_ == 1 || steps_ > power_) {
    power_ *= 2;
    steps_ = 1;
    mark_ = state;
    at_mark_.clear();
  }
  return false;
}

}  // namespace irt::checker
