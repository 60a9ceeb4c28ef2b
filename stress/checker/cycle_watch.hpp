/// Whether code that runs alone has come back to a state that it was in before, in which case it
/// will do so for ever: Brent's cycle detection (1980) over the states at its reads, where a state
/// is what its registers and stack hold and what it has written to memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace irt::checker {

class CycleWatch {
 public:
  /// Forgets everything: from here on the code runs alone.
  void begin();
  /// `size` bytes at `address` are about to be written.
  void note_write(std::uintptr_t address, std::size_t size);
  /// The code is at a read, and `state` stands for its registers, its stack and the place. True if
  /// it was in the same state before, and memory was as it is now.
  bool repeats(std::uint64_t state);
  /// Whether memory holds what it did at `begin`, where `matters(address)` says that it matters.
  template <class Matters>
  [[nodiscard]] bool restored(Matters matters) const {
    for (const auto& [address, word] : at_begin_)
      if (word_at(address) != word && matters(address)) return false;
    return true;
  }

 private:
  /// By address / 8 * 8: what was there.
  using Words = std::unordered_map<std::uintptr_t, std::uint64_t>;

  static std::uint64_t word_at(std::uintptr_t address);

  Words at_begin_;
  Words at_mark_;  ///< of what was written since the mark
  std::uint64_t mark_ = 0;
  std::uint64_t steps_ = 0;  ///< since the mark
  std::uint64_t power_ = 1;
};

}  // namespace irt::checker
