/// Who holds which cache line, who asks for it, and what that costs: the coherence model.
///
/// A core that holds a line uses it at the price of a hit. Otherwise it sends a request, which
/// travels for a share `overlap` of the transfer and queues at the line; a line serves one request
/// at a time. With L the transfer from the owner (or, of a clean copy, `shared_fetch` times the
/// transfer from where it was last used), and `start` the moment when the line is free:
///
///     done = start + (1 - overlap) L + (conflict, if others wait)
///     a read leaves the line busy until `done` if an owner gave it, else for `read_occupancy`
///     ownership also waits for the farthest sharer to give up its copy, and for every other one
///       `invalidate_per_sharer`; it leaves the line busy until the operation is done, and for its
///       `residence` at least, in which the owner's further operations are hits
///
/// Who of those that wait is served next says arbitration.hpp. Every leg varies by up to a tenth
/// and the residence by up to a half, from the run's seed, so that cores do not march in step.
///
/// Not modelled: capacity (caches hold everything), prefetching, several requests of one core in
/// flight (but for posted stores).
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "bench/many_core/coherence/arbitration.hpp"
#include "bench/many_core/coherence/costs.hpp"

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
  bool held_by(unsigned core) const { return owner == core || sharers.has(core); }
};

class Directory {
 public:
  Directory(const Profile& profile, EventQueue& events, std::uint64_t seed);

  /// The line, or null if it was never used.
  Line* find(std::uint64_t number) const {
    std::size_t at = slot_of(number);
    while (slots_[at].line != nullptr) {
      if (slots_[at].number == number) return slots_[at].line;
      at = (at + 1) & (slots_.size() - 1);
    }
    return nullptr;
  }
  Line& make(std::uint64_t number);

  /// Sends `request`, which must live until it is served.
  void send(Line& line, Request& request, Time now);

  struct Served {
    Request* request;
    Time done;
    bool moved;  ///< not, where the core held the line by then
  };
  /// The line's event, at a moment when it is free: serves one request.
  Served serve(Line& line, Time now);

  /// Forgets what was noted of lines so far.
  void reset_statistics();

  const std::deque<Line>& lines() const { return lines_; }
  const Topology& topology() const { return topology_; }

 private:
  struct Slot {
    std::uint64_t number = 0;
    Line* line = nullptr;
  };

  std::size_t slot_of(std::uint64_t number) const {
    return static_cast<std::size_t>(number * 0x9E3779B97F4A7C15U >> shift_);
  }
  // A transfer: the way of the request, which overlaps with others', and the rest.
  struct Way {
    Time request = 0, data = 0;
  };

  void grow();
  // Uniform within a `share`th of `time`.
  template <Time share>
  Time vary(Time time) {
    return time + time * (static_cast<Time>(random_.next() & 2047U) - 1024) / (1024 * share);
  }
  const Way& way(unsigned from, unsigned to, unsigned home, bool clean) const {
    const bool remote = home != topology_.socket(to);
    return ways_[(remote ? 2U : 0U) + (clean ? 1U : 0U)]
                [static_cast<std::size_t>(topology_.distance(from, to))];
  }
  // What `core` pays for the line where it is now.
  const Way& way_to(const Line& line, unsigned core) const {
    if (line.owner != nobody) return way(line.owner, core, line.home, false);
    return line.last == nobody ? from_memory_ : way(line.last, core, line.home, true);
  }
  Time pass_bus(const Line& line, const Request& request, Time start);
  static void note(Line& line, const Request& request, Time done);

  Topology topology_;
  EventQueue& events_;
  // By distance: of a line with an owner, of a clean copy; the same with the home elsewhere.
  std::array<std::array<Way, distances>, 4> ways_{};
  Way from_memory_;
  Time conflict_, residence_, read_occupancy_, per_sharer_, far_, bus_;
  unsigned bypass_;
  bool in_turn_;
  std::vector<Time> bus_free_;
  Random random_;
  std::vector<Slot> slots_;
  unsigned shift_;
  std::deque<Line> lines_;
  std::deque<Waiting> waitings_;
  std::vector<Waiting*> unused_;  // of `waitings_`
};

}  // namespace irt::many_core
