/// A profile in the simulator's units, with the distances worked out.
#pragma once

#include <array>
#include <bit>
#include <vector>

#include "bench/many_core/coherence/events.hpp"
#include "bench/many_core/profiles/profile.hpp"

namespace irt::many_core {

/// Rounded to the nearest, halves upwards; `ns` is not negative.
inline Time picoseconds(double ns) {
  const double exact = ns * static_cast<double>(nanosecond);
  const auto whole = static_cast<Time>(exact);
  return whole + (exact - static_cast<double>(whole) >= 0.5 ? 1 : 0);
}

/// What a core does alone. A core whose sibling works has slower ones.
struct LocalCosts {
  Time load_hit, store_hit, rmw_hit, plain_op, pause;
  double slowdown;

  LocalCosts(const Profile& p, double factor)
      : load_hit(picoseconds(p.load_hit * factor)),
        store_hit(picoseconds(p.store_hit * factor)),
        rmw_hit(picoseconds(p.rmw_hit * factor)),
        plain_op(picoseconds(p.plain_op * factor)),
        pause(picoseconds(p.pause * factor)),
        slowdown(factor) {}
};

/// Hardware threads in an order in which every group of the topology is a range: siblings side by
/// side, then the cores of a cache, and so on. The simulator numbers them so.
class Topology {
 public:
  explicit Topology(const Profile& profile) : paths_(profile.threads()) {
    for (unsigned thread = 0; thread < paths_.size(); ++thread) {
      std::uint64_t path = 0;
      for (const unsigned group : {profile.socket_of(thread), profile.node_of(thread),
                                   profile.cache_of(thread), profile.core_of(thread), thread})
        path = path << level_bits | group;
      paths_[place_of(profile, thread)] = path;
    }
  }

  /// Where the profile's hardware thread `thread` stands in this order.
  static unsigned place_of(const Profile& profile, unsigned thread) {
    return profile.core_of(thread) * profile.smt + thread / profile.cores();
  }

  [[nodiscard]] Distance distance(unsigned a, unsigned b) const {
    const auto differ = static_cast<unsigned>(std::bit_width(paths_[a] ^ paths_[b]));
    return static_cast<Distance>((differ + level_bits - 1) / level_bits);
  }
  [[nodiscard]] unsigned socket(unsigned place) const {
    return static_cast<unsigned>(paths_[place] >> 4 * level_bits);
  }

 private:
  static constexpr unsigned level_bits = 12;
  static_assert(max_cores <= 1U << level_bits);

  // Socket, node, cache, core and thread, the socket in the highest bits: the highest level in
  // which two differ is their distance.
  std::vector<std::uint64_t> paths_;
};

}  // namespace irt::many_core
