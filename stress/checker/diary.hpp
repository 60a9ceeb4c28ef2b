/// What each thread of an execution saw of memory and did to it besides its events: with these, all
/// that what it does next can depend on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stress/virtual_cores/virtual_cores.hpp"

namespace irt::checker {

/// A look at eight bytes, or a block allocated or freed.
struct Look {
  enum class Kind : std::uint8_t { read, write, allocate, release } kind = Kind::read;
  std::uint8_t bytes = 0;      ///< of the eight, a bit for each
  std::uint16_t moment = 0;    ///< so many events of its thread came before
  std::uintptr_t address = 0;  ///< a multiple of eight; of a block, as it is
  /// What was there before, the other bytes zero; of a block, its size.
  std::uint64_t found = 0;
  /// Of a write: what the thread left there when it made its next event.
  std::uint64_t left = 0;
};

/// The eight bytes at `address`, those without a bit in `bytes` zero.
std::uint64_t masked_word(std::uintptr_t address, std::uint8_t bytes);

class Diary {
 public:
  explicit Diary(unsigned threads) : looks_(threads), settled_(threads) {}

  void clear();
  void note(Look::Kind kind, unsigned thread, std::size_t moment, std::uintptr_t address,
            std::size_t size);
  void note_block(Look::Kind kind, unsigned thread, std::size_t moment, std::uintptr_t address,
                  std::size_t size) {
    looks_[thread].push_back({kind, 0, static_cast<std::uint16_t>(moment), address, size, 0});
  }
  /// `thread` is about to make an event, so that others may see what it wrote.
  void settle(unsigned thread) {
    if (settled_[thread] != looks_[thread].size()) take_in(thread);
  }
  /// What a thread was told is another thing for each.
  void note_peculiar(const char* what) { peculiar_ = what; }

  [[nodiscard]] const std::vector<Look>& of(unsigned thread) const { return looks_[thread]; }
  [[nodiscard]] const std::string& peculiar() const { return peculiar_; }

 private:
  void take_in(unsigned thread);

  std::vector<std::vector<Look>> looks_;
  std::vector<std::size_t> settled_;
  std::string peculiar_;
};

}  // namespace irt::checker
