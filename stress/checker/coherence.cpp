#include "stress/checker/coherence.hpp"

#include <algorithm>

namespace irt::checker {

std::size_t lowest_readable(const Graph& graph, unsigned thread, std::uint32_t id) {
  const Location& location = graph.location(id);
  const Clock& now = graph.thread(thread).now;
  std::size_t lowest = location.stores.size() - 1;
  while (lowest > 0 && !happens_before(graph.event(location.stores[lowest]), now)) --lowest;
  if (lowest + 1 == location.stores.size()) return lowest;
  // What a thread read last, of all that happens before, is no older than what it read before that.
  std::uint32_t left = location.readers;
  for (auto read = location.reads.rbegin(); left != 0 && read != location.reads.rend(); ++read) {
    const Event& event = graph.event(*read);
    const std::uint32_t reader = 1U << event.thread;
    if ((left & reader) == 0 || !happens_before(event, now)) continue;
    left &= ~reader;
    lowest = std::max(lowest, place_of(graph, event.from));
    if (lowest + 1 == location.stores.size()) break;
  }
  return lowest;
}

bool free_to_modify(const Graph& graph, std::uint32_t id, std::size_t place) {
  const Location& location = graph.location(id);
  if (place + 1 == location.stores.size()) return true;
  const Event& next = graph.event(location.stores[place + 1]);
  return !(next.reads && next.from == location.stores[place]);
}

bool free_to_place(const Graph& graph, std::uint32_t id, std::size_t place) {
  return place == graph.location(id).stores.size() || free_to_modify(graph, id, place - 1);
}

std::size_t place_of(const Graph& graph, EventId store) {
  const std::vector<EventId>& stores = graph.location(graph.event(store).location).stores;
  std::size_t place = stores.size() - 1;
  while (stores[place] != store) --place;
  return place;
}

std::optional<std::size_t> find_place(const Graph& graph, std::uint32_t id, EventId store) {
  const std::vector<EventId>& stores = graph.location(id).stores;
  const auto found = std::find(stores.rbegin(), stores.rend(), store);
  if (found == stores.rend()) return std::nullopt;
  return static_cast<std::size_t>(stores.rend() - found) - 1;
}

}  // namespace irt::checker
