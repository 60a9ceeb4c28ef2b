/// A set of hardware threads.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "bench/many_core/profiles/profile.hpp"

namespace irt::many_core {

inline constexpr unsigned nobody = ~0U;

class CoreSet {
 public:
  [[nodiscard]] bool has(unsigned core) const { return (words_[core / 64] >> core % 64 & 1U) != 0; }
  void add(unsigned core) { words_[core / 64] |= std::uint64_t{1} << core % 64; }
  void clear() { words_ = {}; }

  /// The lowest and the highest but `except`; `nobody` if there is none.
  [[nodiscard]] unsigned lowest(unsigned except) const {
    for (unsigned i = 0; i < words_.size(); ++i)
      if (const std::uint64_t word = without(except, i); word != 0)
        return 64 * i + static_cast<unsigned>(std::countr_zero(word));
    return nobody;
  }
  [[nodiscard]] unsigned highest(unsigned except) const {
    for (auto i = static_cast<unsigned>(words_.size()); i-- > 0;)
      if (const std::uint64_t word = without(except, i); word != 0)
        return 64 * i + static_cast<unsigned>(std::bit_width(word)) - 1;
    return nobody;
  }

 private:
  [[nodiscard]] std::uint64_t without(unsigned core, unsigned i) const {
    return core / 64 == i ? words_[i] & ~(std::uint64_t{1} << core % 64) : words_[i];
  }

  std::array<std::uint64_t, max_cores / 64> words_{};
};

}  // namespace irt::many_core
