#include "stress/checker/symmetry.hpp"

#include <algorithm>

#include "stress/checker/heap.hpp"

namespace irt::checker {

namespace {

/// Whether event number k of `a` and of `b`, until which they were alike, leaves them so.
bool same(const Graph& graph, const Heap& heap, const Event& a, const Event& b) {
  if (a.kind != b.kind || a.pc != b.pc || a.order != b.order || a.blocked != b.blocked ||
      a.option != b.option)
    return false;
  if (!a.reads && !a.writes) return true;
  const bool own = heap.region_of(graph.location(a.location).address) == a.thread;
  if (!own) return a.location == b.location && !a.writes && a.from == b.from;
  if (heap.twin(graph.location(a.location).address, a.thread, b.thread) !=
      graph.location(b.location).address)
    return false;
  if (!a.reads) return true;
  const Event& from = graph.event(a.from);
  const Event& other = graph.event(b.from);
  if (from.kind == EventKind::initial || other.kind == EventKind::initial)
    return from.kind == other.kind;
  if (from.thread == a.thread && other.thread == b.thread) return from.index == other.index;
  return false;
}

}  // namespace

bool is_own(const Graph& graph, const Heap& heap, std::uint32_t location, unsigned a, unsigned b) {
  const auto region = heap.region_of(graph.location(location).address);
  return region == a || region == b;
}

Symmetry::Symmetry(std::vector<unsigned> roles) : roles_(std::move(roles)) {
  for (std::size_t i = 0; i < roles_.size(); ++i)
    any_ = any_ || std::ranges::count(roles_, roles_[i]) > 1;
}

void Symmetry::begin() {
  same_ = {};
}

const Event* Symmetry::rival(const Graph& graph, unsigned lower, unsigned thread,
                             std::size_t index) const {
  if (roles_[lower] != roles_[thread] || same_[lower][thread] + 1U < index) return nullptr;
  const std::vector<EventId>& events = graph.thread(lower).events;
  return events.size() < index ? nullptr : &graph.event(events[index - 1]);
}

Clock Symmetry::past(const Graph& graph, unsigned thread, std::size_t index) const {
  Clock clock;
  for (unsigned lower = 0; any_ && lower < thread; ++lower)
    if (const Event* event = rival(graph, lower, thread, index)) clock.join(event->causes);
  return clock;
}

void Symmetry::added(const Graph& graph, const Heap& heap, const Event& event) {
  for (unsigned lower = 0; any_ && lower < event.thread; ++lower) {
    if (roles_[lower] != roles_[event.thread] || same_[lower][event.thread] + 1U != event.index)
      continue;
    const Event* other = rival(graph, lower, event.thread, event.index);
    broken_ = broken_ || other == nullptr;
    if (other != nullptr && same(graph, heap, *other, event)) ++same_[lower][event.thread];
  }
}

bool Symmetry::forbids_option(const Graph& graph, unsigned thread, std::size_t index,
                              std::uint32_t option) const {
  for (unsigned lower = 0; any_ && lower < thread; ++lower)
    if (const Event* event = rival(graph, lower, thread, index);
        event != nullptr && event->kind == EventKind::choice && option > event->option)
      return true;
  return false;
}

}  // namespace irt::checker
