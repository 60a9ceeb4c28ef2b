/// MESI, kept by a directory: who holds a line, who gives it up for whom, and what that costs. All
/// rules of coherence stand here; another protocol would answer the same four questions: does a
/// request move the line, how long is its way, how long the transfer, and what is the line then.
///
/// A line that is *modified* or *exclusive* has an owner, who may write to it at the price of a
/// hit. The two are one here, for the first write to an exclusive line asks nobody. A *shared* line
/// has sharers, who may read it at that price. Of an *invalid* one, with neither, memory has the
/// only copy, or the cache that `last` used it in.
///
/// A request travels for a share `overlap` of the transfer and queues at the line. With L the
/// transfer from the owner (or, of a clean copy, `shared_fetch` times the transfer from where it
/// was last used), and `start` the moment when the line serves it:
///
///     done = start + (1 - overlap) L + (conflict, if others wait)
///     a read leaves the line busy until `done` if an owner gave it, and for its `write_back` if
///       that had changed it, else for `read_occupancy`
///     ownership also waits for the farthest sharer to give up its copy, and for every other one
///       `invalidate_per_sharer`; it leaves the line busy until the operation is done, and for its
///       `residence` at least, in which the owner's further operations are hits
///
/// Every leg varies by up to a tenth and the residence by up to a half, from the run's seed, so
/// that cores do not march in step.
///
/// Not modelled: capacity (caches hold everything), prefetching, several requests of one core in
/// flight (but for posted stores).
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "bench/many_core/coherence/costs.hpp"
#include "bench/many_core/coherence/line.hpp"
#include "bench/many_core/coherence/random.hpp"

namespace irt::many_core {

class Mesi {
 public:
  Mesi(const Profile& profile, std::uint64_t seed);

  [[nodiscard]] const Topology& topology() const { return topology_; }
  /// All randomness of the run.
  Random& random() { return random_; }

  /// Whether the core does not hold what it asks for, so that the line moves.
  static bool moves(const Line& line, const Request& request) {
    if (line.owner == request.core) return false;
    return request.want != Want::copy || !line.sharers.has(request.core);
  }

  /// How long the request is on its way to the line.
  Time request_time(const Line& line, unsigned core) {
    return vary<10>(line.owner == core ? 0 : way_to(line, core).request);
  }

  /// When a request that moves the line, and is served at `start`, has it. `contended`: others
  /// wait.
  [[gnu::always_inline]] inline Time transfer(const Line& line, const Request& request, Time start,
                                              bool contended) {
    if (bus_ != 0) start = pass_bus(line, request, start);
    if (contended) start += conflict_;
    const bool holds = line.sharer_count != 0 && line.sharers.has(request.core);
    const unsigned others = line.sharer_count - (holds ? 1U : 0U);
    Time done = start;
    if (!holds || others == 0) done += vary<10>(way_to(line, request.core).data);
    if (request.want != Want::copy && others != 0)
      done = std::max(done, start + vary<10>(farthest_answer(line, request.core))) +
             per_sharer_ * static_cast<Time>(others - 1);
    return done;
  }

  /// Makes the line what it is when the request, served at `start`, has it at `done`; says when it
  /// is free again. Returns when the request is through.
  [[gnu::always_inline]] inline Time transition(Line& line, const Request& request, Time start,
                                                Time done) {
    switch (request.want) {
      case Want::copy:
        read(line, request.core, start, done);
        break;
      case Want::ownership:
        done = std::max(done, line.read_done);
        line.drop_sharers();
        line.owner = request.core;
        line.available = done + std::max(vary<2>(residence_), request.takes);
        break;
      case Want::far:
        // The operation is done at the home as soon as the owner has given the line up; the answer
        // travels while the next one is done.
        line.available = (line.is_invalid() ? start : done) + far_;
        line.drop_sharers();
        line.owner = nobody;
        break;
    }
    line.last = request.core;
    return done;
  }

 private:
  // A transfer: the way of the request, which overlaps with others', and the rest.
  struct Way {
    Time request = 0, data = 0;
  };

  // Uniform within a `share`th of `time`.
  template <Time share>
  Time vary(Time time) {
    return time + time * (static_cast<Time>(random_.next() & 2047U) - 1024) / (1024 * share);
  }
  [[nodiscard]] const Way& way(unsigned from, unsigned to, unsigned home, bool clean) const {
    const bool remote = home != topology_.socket(to);
    return ways_[(remote ? 2U : 0U) + (clean ? 1U : 0U)]
                [static_cast<std::size_t>(topology_.distance(from, to))];
  }
  // What `core` pays for the line where it is now.
  [[nodiscard]] const Way& way_to(const Line& line, unsigned core) const {
    if (line.owner != nobody) return way(line.owner, core, line.home, false);
    return line.last == nobody ? from_memory_ : way(line.last, core, line.home, true);
  }
  // Every other copy is given up; the farthest answer counts.
  [[nodiscard]] Time farthest_answer(const Line& line, unsigned core) const {
    return std::max(way(line.sharers.lowest(core), core, line.home, false).data,
                    way(line.sharers.highest(core), core, line.home, false).data);
  }
  Time pass_bus(const Line& line, const Request& request, Time start);

  void read(Line& line, unsigned core, Time start, Time done) const {
    if (line.owner != nobody && line.owner != core) {
      line.share_with(line.owner);
      line.share_with(core);
      line.owner = nobody;
      line.available = done + (line.written != 0 ? write_back_ : 0);
    } else if (line.is_invalid() && line.only_mine) {
      line.owner = core;
      line.available = done;
    } else if (line.owner == nobody) {
      line.share_with(core);
      line.available = start + read_occupancy_;
    }
    line.read_done = std::max(line.read_done, done);
  }

  Topology topology_;
  Random random_;
  // By distance: of a line with an owner, of a clean copy; the same with the home elsewhere.
  std::array<std::array<Way, distances>, 4> ways_{};
  Way from_memory_;
  Time conflict_, residence_, read_occupancy_, write_back_, per_sharer_, far_, bus_;
  std::vector<Time> bus_free_;  // by socket
};

inline Mesi::Mesi(const Profile& p, std::uint64_t seed)
    : topology_(p),
      random_(seed),
      conflict_(picoseconds(p.conflict)),
      residence_(picoseconds(p.residence)),
      read_occupancy_(picoseconds(p.read_occupancy)),
      write_back_(picoseconds(p.write_back)),
      per_sharer_(picoseconds(p.invalidate_per_sharer)),
      far_(picoseconds(p.far_atomic)),
      bus_(picoseconds(p.bus_occupancy)),
      bus_free_(p.sockets) {
  const auto parts = [&p](double ns) {
    return Way{picoseconds(p.overlap * ns), picoseconds((1 - p.overlap) * ns)};
  };
  for (unsigned i = 0; i < distances; ++i) {
    const auto distance = static_cast<Distance>(i);
    // The line's home is nearer than any other core could be.
    const double ns = p.transfer[std::max<std::size_t>(
        i, distance == Distance::self ? static_cast<std::size_t>(Distance::same_cache) : 0)];
    const bool via_home = distance == Distance::same_node || distance == Distance::same_socket;
    const double detour = via_home ? p.home_remote : 0;
    ways_[0][i] = parts(ns);
    ways_[1][i] = parts(p.shared_fetch * ns);
    ways_[2][i] = parts(ns + detour);
    ways_[3][i] = parts(p.shared_fetch * (ns + detour));
  }
  from_memory_ = parts(p.dram);
}

// A transfer that leaves its cache takes the front-side bus of both sockets, one after the other
// transfers there. Returns when it may start.
inline Time Mesi::pass_bus(const Line& line, const Request& request, Time start) {
  const unsigned from = line.owner != nobody ? line.owner : line.last;
  if (from != nobody && topology_.distance(from, request.core) <= Distance::same_cache)
    return start;
  const unsigned here = topology_.socket(request.core);
  const unsigned there = from == nobody ? here : topology_.socket(from);
  start = std::max({start, bus_free_[here], bus_free_[there]});
  bus_free_[here] = bus_free_[there] = start + bus_;
  return start;
}

}  // namespace irt::many_core
