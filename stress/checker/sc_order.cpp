// The total order S of seq_cst operations, [atomics.order] of C++20, paragraphs 3 and 4.
//
// S exists exactly if this relation over seq_cst operations and fences has no cycle:
//   - A strongly happens before B: same thread; or A is sequenced before some X, X simply happens
//     before some Y, and Y is sequenced before B. (A synchronizes with B, both seq_cst, is covered
//     by the next.)
//   - A is coherence-ordered before B; or the same for an X and a Y with A = X or A a fence that
//     happens before X, and B = Y or B a fence that Y happens before.
// Coherence order at one location is read off the modification order: store i, its reads, store
// i + 1, ...

#include <algorithm>
#include <array>
#include <bitset>

#include "stress/checker/graph.hpp"

namespace irt::checker {

namespace {

constexpr std::size_t max_nodes = 512;
using Nodes = std::bitset<max_nodes>;

}  // namespace

bool Graph::seq_cst_order_exists() const {
  const std::size_t nodes = std::min(seq_cst_.size(), max_nodes);
  if (nodes < 2) return true;
  static std::array<Nodes, max_nodes> successors;
  for (std::size_t i = 0; i < nodes; ++i) successors[i].reset();

  std::vector<std::size_t> fences;
  for (std::size_t i = 0; i < nodes; ++i) {
    const Event& a = events_[seq_cst_[i]];
    if (a.kind == EventKind::fence) fences.push_back(i);
    for (std::size_t j = 0; j < nodes; ++j) {
      const Event& b = events_[seq_cst_[j]];
      if (i != j && (a.thread == b.thread ? a.index < b.index : b.before.count[a.thread] > a.index))
        successors[i].set(j);
    }
  }

  // The accesses to one location that matter to S, with the nodes they stand for.
  struct Access {
    std::size_t position;
    Nodes from;  // as the earlier of two
    Nodes to;    // as the later
  };
  std::vector<Access> accesses;
  for (std::size_t l = 0; l < location_count_; ++l) {
    const Location& location = locations_[l];
    if (location.stores.size() == 1) continue;
    accesses.clear();
    const auto add = [&](EventId id, std::size_t position) {
      const Event& event = events_[id];
      Access access{position, {}, {}};
      if (event.order == Order::seq_cst && event.kind != EventKind::initial) {
        const auto node = std::find(seq_cst_.begin(), seq_cst_.end(), id) - seq_cst_.begin();
        access.from.set(static_cast<std::size_t>(node));
        access.to.set(static_cast<std::size_t>(node));
      }
      for (const std::size_t f : fences) {
        const Event& fence = events_[seq_cst_[f]];
        if (event.kind != EventKind::initial && happens_before(fence, event.after))
          access.from.set(f);
        if (happens_before(event, fence.after)) access.to.set(f);
      }
      if (access.from.any() || access.to.any()) accesses.push_back(access);
    };
    for (std::size_t place = 0; place < location.stores.size(); ++place)
      add(location.stores[place], 2 * place);
    for (const EventId read : location.reads)
      if (!events_[read].writes) add(read, 2 * place_of(events_[read].from) + 1);
    std::sort(accesses.begin(), accesses.end(),
              [](const Access& x, const Access& y) { return x.position > y.position; });
    Nodes later;
    Nodes here;
    std::size_t position = accesses.empty() ? 0 : accesses.front().position;
    for (const Access& access : accesses) {
      if (access.position != position) later |= here;
      position = access.position;
      here |= access.to;
      for (std::size_t i = access.from._Find_first(); i < nodes; i = access.from._Find_next(i))
        successors[i] |= later;
    }
  }

  // Take away what has no successor left until nothing changes; a rest is a cycle.
  Nodes left;
  for (std::size_t i = 0; i < nodes; ++i) left.set(i);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < nodes; ++i) {
      if (!left[i] || (successors[i] & left).any()) continue;
      left.reset(i);
      changed = true;
    }
  }
  return left.none();
}

bool Graph::try_out(Event& event, std::uint32_t id, std::size_t place, bool reads, bool writes) {
  const Event saved = event;
  ThreadClocks& mine = threads_[event.thread];
  const Clock now = mine.now;
  const Clock causes = mine.causes;
  const Clock pending = mine.pending;
  if (reads && writes)
    finish_modify(event, id, place, 0);
  else if (reads)
    finish_load(event, id, place);
  else
    finish_store(event, id, place, 0);
  const bool allowed = seq_cst_order_exists();
  --count_;
  mine.now = now;
  mine.causes = causes;
  mine.pending = pending;
  mine.events.pop_back();
  if (event.order == Order::seq_cst) seq_cst_.pop_back();
  Location& location = locations_[id];
  if (reads) location.reads.pop_back();
  if (writes)
    location.stores.erase(location.stores.begin() +
                          static_cast<std::ptrdiff_t>(reads ? place + 1 : place));
  event = saved;
  return allowed;
}

// What reads the newest store or becomes it comes after everything: nothing that was in order can
// be put out of order by it, so only other places need the test.

bool Graph::allows_read(Event& event, std::uint32_t id, std::size_t place, bool modifies) {
  return place + 1 == locations_[id].stores.size() || seq_cst_.empty() ||
         try_out(event, id, place, true, modifies);
}

bool Graph::allows_place(Event& event, std::uint32_t id, std::size_t place) {
  return place == locations_[id].stores.size() || seq_cst_.empty() ||
         try_out(event, id, place, false, true);
}

}  // namespace irt::checker
