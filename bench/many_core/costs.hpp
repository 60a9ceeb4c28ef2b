/// A profile in the simulator's units, with the distances worked out.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "bench/many_core/events.hpp"
#include "bench/many_core/profile.hpp"

namespace irt::many_core {

inline Time picoseconds(double ns) {
  return std::llround(ns * static_cast<double>(nanosecond));
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
  explicit Topology(const Profile& profile) : places_(profile.threads()) {
    for (unsigned thread = 0; thread < places_.size(); ++thread) {
      const unsigned core = profile.core_of(thread);
      places_[place_of(profile, thread)] = {static_cast<std::uint16_t>(core),
                                            static_cast<std::uint16_t>(profile.cache_of(thread)),
                                            static_cast<std::uint16_t>(profile.node_of(thread)),
                                            static_cast<std::uint16_t>(profile.socket_of(thread))};
    }
  }

  /// Where the profile's hardware thread `thread` stands in this order.
  static unsigned place_of(const Profile& profile, unsigned thread) {
    return profile.core_of(thread) * profile.smt + thread / profile.cores();
  }

  Distance distance(unsigned a, unsigned b) const {
    if (a == b) return Distance::self;
    const Place& x = places_[a];
    const Place& y = places_[b];
    if (x.core == y.core) return Distance::smt_sibling;
    if (x.cache == y.cache) return Distance::same_cache;
    if (x.node == y.node) return Distance::same_node;
    return x.socket == y.socket ? Distance::same_socket : Distance::other_socket;
  }
  unsigned core(unsigned place) const { return places_[place].core; }
  unsigned socket(unsigned place) const { return places_[place].socket; }

 private:
  struct Place {
    std::uint16_t core, cache, node, socket;
  };
  std::vector<Place> places_;
};

}  // namespace irt::many_core
