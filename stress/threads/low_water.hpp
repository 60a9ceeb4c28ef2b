/// Whether memory grows for ever: what is held when next to nothing is inside, over a long run.
///
/// Reclaimers free in batches and caches fill up, so a slope means nothing by itself: memory that
/// is given back once in P pushes grows with every push until then. Two things tell a leak. What is
/// held at least, between one doubling of the pushes and the next, keeps its slope: a batch that
/// was given back meanwhile, a cache that is full and a highest mark that is topped more and more
/// seldom (by a logarithm, or by a root) do not. And that goes on for longer than a batch or a
/// cache can explain: `enough_pushes`, or `enough_bytes`. Before that nobody can know.
#pragma once

#include <array>
#include <cstdint>

namespace irt::stress {

class LowWater {
 public:
  /// A batch or a cache of that many elements is taken for none at all.
  static constexpr std::uint64_t enough_pushes = std::uint64_t{1} << 24;
  /// The same of memory, held for a queue with next to nothing inside.
  static constexpr std::int64_t enough_bytes = std::int64_t{256} << 20;
  /// Less is no growth: bytes per push. A leak of one small node in 8,192 pushes is not seen.
  static constexpr double slight = 1.0 / 256;

  enum class Growth : std::uint8_t {
    none,       ///< not over the last doubling of the pushes, or less and less
    undecided,  ///< so far, as batches and caches do at first
    unbounded,  ///< in proportion to the pushes, for longer than those explain
  };

  /// `bytes` were held after `pushes`; `pushes` never falls. Call it while little is inside, many
  /// times in every doubling.
  void add(std::uint64_t pushes, std::int64_t bytes);

  [[nodiscard]] Growth growth() const;

  /// What was held at least from `pushes` on.
  struct Mark {
    std::uint64_t pushes = 0;
    std::int64_t bytes = 0;
  };
  /// What growth is judged by: four doublings of the pushes that are complete, oldest first, and
  /// the last eighth of a doubling. Marks without pushes where there are fewer.
  static constexpr unsigned judged = 5;
  [[nodiscard]] std::array<Mark, judged> marks() const;

 private:
  static constexpr unsigned parts = 8;  ///< of a doubling

  std::array<Mark, 64 * parts> lowest_{};  ///< of each part
  unsigned now_ = 0;                       ///< the part that is not complete yet
};

}  // namespace irt::stress
