/// A cache line: who holds it, who waits for it, and what is noted of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/many_core/coherence/arbitration.hpp"
#include "bench/many_core/coherence/core_set.hpp"
#include "bench/many_core/coherence/events.hpp"

namespace irt::many_core {

inline constexpr unsigned line_bytes = 64;

/// Where in the code a line was asked for, and what that cost.
struct Site {
  const void* pc = nullptr;
  std::uint64_t requests = 0;
  Time waited = 0;
  bool writes = false;
};

struct Watch;

/// The bytes of a line that an access uses, a bit each. What lies past the line is left out.
inline std::uint64_t bytes_of(std::uintptr_t address, std::size_t size) {
  const std::uint64_t mask =
      size >= line_bytes ? ~std::uint64_t{0} : (std::uint64_t{1} << size) - 1;
  return mask << address % line_bytes;
}

/// What a hit uses comes first and lies together.
struct alignas(line_bytes) Line {
  std::uint64_t number = 0;  ///< address / 64
  Time available = 0;        ///< when the next request may be served
  Time read_done = 0;        ///< when the last reader has its copy
  unsigned owner = nobody;   ///< who may write
  unsigned last = nobody;    ///< who got it last: a clean copy comes from there; nobody: memory
  std::uint16_t sharer_count = 0;
  std::uint16_t home = 0;  ///< socket
  bool used = false;       ///< by anybody, in simulated time
  bool only_mine = true;   ///< nobody but `last` has ever used it
  bool only_read = true;   ///< nobody has ever written to it in simulated time
  // What the owner and the readers have used since ownership last moved, a bit per byte.
  std::uint64_t written = 0, read = 0;
  Waiting* waiting = nullptr;  ///< null while nobody waits
  CoreSet sharers;
  Event event;
  Watch* watchers = nullptr;  ///< who sleeps until the line changes hands

  std::uint64_t transfers = 0, false_transfers = 0;
  Time waited = 0;
  std::vector<Site> sites;

  void share_with(unsigned core) {
    if (sharers.has(core)) return;
    sharers.add(core);
    ++sharer_count;
  }
  void drop_sharers() {
    if (sharer_count != 0) sharers.clear();
    sharer_count = 0;
  }
  [[nodiscard]] bool is_invalid() const { return owner == nobody && sharer_count == 0; }
  [[nodiscard]] bool held_by(unsigned core) const { return owner == core || sharers.has(core); }
  /// `core` is about to use it.
  void note_user(unsigned core) {
    only_mine = only_mine && (!used || last == core);
    used = true;
  }
};

}  // namespace irt::many_core
