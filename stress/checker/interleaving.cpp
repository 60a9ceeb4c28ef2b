#include "stress/checker/interleaving.hpp"

#include <algorithm>
#include <functional>
#include <queue>

namespace irt::checker {

std::optional<std::vector<EventId>> interleaving(const Graph& graph) {
  std::vector<std::vector<EventId>> later(graph.size());
  std::vector<unsigned> missing(graph.size(), 0);
  const auto order = [&](EventId first, EventId second) {
    if (first == second || graph.event(first).kind == EventKind::initial) return;
    later[first].push_back(second);
    ++missing[second];
  };
  std::size_t events = 0;
  for (EventId id = 0; id < graph.size(); ++id) {
    const Event& event = graph.event(id);
    if (event.kind == EventKind::initial) continue;
    ++events;
    if (event.index > 1) order(graph.thread(event.thread).events[event.index - 2U], id);
    if (!event.reads) continue;
    order(event.from, id);
    const std::vector<EventId>& stores = graph.location(event.location).stores;
    const auto from = std::ranges::find(stores, event.from);
    if (from != stores.end() && from + 1 != stores.end()) order(id, *(from + 1));
  }
  for (std::uint32_t location = 0; location < graph.locations(); ++location) {
    const std::vector<EventId>& stores = graph.location(location).stores;
    for (std::size_t i = 1; i < stores.size(); ++i) order(stores[i - 1], stores[i]);
  }
  std::priority_queue<EventId, std::vector<EventId>, std::greater<>> ready;
  for (EventId id = 0; id < graph.size(); ++id)
    if (missing[id] == 0 && graph.event(id).kind != EventKind::initial) ready.push(id);
  std::vector<EventId> result;
  while (!ready.empty()) {
    const EventId next = ready.top();
    ready.pop();
    result.push_back(next);
    for (const EventId id : later[next])
      if (--missing[id] == 0) ready.push(id);
  }
  if (result.size() != events) return std::nullopt;
  return result;
}

}  // namespace irt::checker
