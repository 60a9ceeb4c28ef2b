#include "bench/many_core/machine/placement.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace irt::many_core {

std::string_view name_of(Placement placement) {
  static constexpr std::array<std::string_view, 3> names{"close", "siblings", "spread"};
  return names[static_cast<std::size_t>(placement)];
}

std::vector<unsigned> place(const Profile& profile, unsigned threads, Placement placement) {
  std::vector<unsigned> order(profile.threads());
  for (unsigned i = 0; i < order.size(); ++i) order[i] = i;
  // Where a hardware thread comes in the order, as its rank among those like it, then the rest.
  const auto by = [&order](auto key) {
    std::ranges::stable_sort(order, [key](unsigned a, unsigned b) { return key(a) < key(b); });
  };
  if (placement == Placement::siblings)
    by([&profile](unsigned thread) { return profile.core_of(thread); });
  if (placement == Placement::spread) {
    const unsigned per_socket = profile.cores() / profile.sockets;
    by([&profile, per_socket](unsigned thread) {
      return std::pair(thread / profile.cores(), profile.core_of(thread) % per_socket);
    });
  }
  std::vector<unsigned> places;
  for (unsigned i = 0; i < threads; ++i) places.push_back(order[i % order.size()]);
  return places;
}

std::vector<Level> levels(const Profile& profile, Placement placement) {
  const std::vector<unsigned> order = place(profile, profile.threads(), placement);
  const auto first = [&order](auto is_beyond) {
    return static_cast<unsigned>(std::ranges::find_if(order, is_beyond) - order.begin());
  };
  std::vector<Level> found;
  const auto within = [&](Distance most, std::string_view name) {
    found.push_back(
        {first([&](unsigned thread) { return profile.distance(order[0], thread) > most; }), name});
  };
  within(Distance::same_cache, "one cache");
  within(Distance::same_node, "one node");
  within(Distance::same_socket, "one socket");
  std::set<unsigned> cores;
  found.push_back(
      {first([&](unsigned thread) { return !cores.insert(profile.core_of(thread)).second; }),
       "a core each"});
  found.push_back({profile.threads(), "all hardware threads"});
  std::erase_if(found, [](const Level& level) { return level.threads < 2; });
  // Of those at the same number the last is the largest group.
  std::ranges::reverse(found);
  std::ranges::stable_sort(found, {}, &Level::threads);
  const auto alike = [](const Level& a, const Level& b) { return a.threads == b.threads; };
  found.erase(std::unique(found.begin(), found.end(), alike), found.end());
  return found;
}

}  // namespace irt::many_core
