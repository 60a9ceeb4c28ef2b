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

/// The relation, for at most `most` operations: small ones fit into a register.
template <std::size_t most>
class Relation {
 public:
  using Nodes = std::bitset<most>;

  Relation(const Graph& graph, const std::vector<EventId>& nodes)
      : graph_(graph), nodes_(nodes), count_(std::min(nodes.size(), most)) {
    for (std::size_t i = 0; i < count_; ++i) successors[i].reset();
  }

  bool is_acyclic() {
    strongly_happens_before();
    for (std::size_t l = 0; l < graph_.locations(); ++l)
      if (graph_.location(static_cast<std::uint32_t>(l)).stores.size() > 1)
        coherence_ordered_before(graph_.location(static_cast<std::uint32_t>(l)));
    // Take away what has no successor left until nothing changes; a rest is a cycle. Most edges
    // follow the order of execution, so that one round from the end is nearly enough.
    Nodes left;
    for (std::size_t i = 0; i < count_; ++i) left.set(i);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = count_; i-- > 0;) {
        if (!left[i] || (successors[i] & left).any()) continue;
        left.reset(i);
        changed = true;
      }
    }
    return left.none();
  }

 private:
  /// An access that matters to S, with the nodes it stands for.
  struct Access {
    std::size_t position;
    Nodes from;  ///< as the earlier of two
    Nodes to;    ///< as the later
  };

  // The last earlier operation of each thread is enough: the ones before precede that.
  void strongly_happens_before() {
    fences.clear();
    for (std::size_t i = 0; i < count_; ++i) {
      const Event& b = graph_.event(nodes_[i]);
      if (b.kind == EventKind::fence) fences.push_back(i);
      Nodes threads;
      for (std::size_t j = i; j-- > 0;) {
        const Event& a = graph_.event(nodes_[j]);
        if (threads[a.thread] || (a.thread != b.thread && b.before.count[a.thread] <= a.index))
          continue;
        threads.set(a.thread);
        successors[j].set(i);
      }
    }
  }

  void add(EventId id, std::size_t position) {
    const Event& event = graph_.event(id);
    Access access{position, {}, {}};
    if (event.node < count_) {
      access.from.set(event.node);
      access.to.set(event.node);
    }
    for (const std::size_t f : fences) {
      const Event& fence = graph_.event(nodes_[f]);
      if (event.kind != EventKind::initial && graph_.happens_before(fence, event.after))
        access.from.set(f);
      if (graph_.happens_before(event, fence.after)) access.to.set(f);
    }
    if (access.from.any() || access.to.any()) accesses.push_back(access);
  }

  void coherence_ordered_before(const Location& location) {
    accesses.clear();
    for (std::size_t place = 0; place < location.stores.size(); ++place)
      add(location.stores[place], 2 * place);
    for (const EventId read : location.reads)
      if (const Event& event = graph_.event(read); !event.writes)
        add(read, 2 * graph_.place_of(event.from) + 1);
    std::sort(accesses.begin(), accesses.end(),
              [](const Access& x, const Access& y) { return x.position > y.position; });
    Nodes later;
    Nodes here;
    std::size_t position = accesses.empty() ? 0 : accesses.front().position;
    for (const Access& access : accesses) {
      if (access.position != position) later |= here;
      position = access.position;
      here |= access.to;
      for (std::size_t i = access.from._Find_first(); i < count_; i = access.from._Find_next(i))
        successors[i] |= later;
    }
  }

  // Kept from one question to the next for their memory only.
  static inline std::array<Nodes, most> successors;
  static inline std::vector<std::size_t> fences;
  static inline std::vector<Access> accesses;

  const Graph& graph_;
  const std::vector<EventId>& nodes_;
  std::size_t count_;
};

}  // namespace

bool Graph::seq_cst_order_exists() const {
  if (seq_cst_.size() < 2) return true;
  if (seq_cst_.size() <= 64) return Relation<64>(*this, seq_cst_).is_acyclic();
  if (seq_cst_.size() <= 512) return Relation<512>(*this, seq_cst_).is_acyclic();
  return seq_cst_.size() <= most_seq_cst && Relation<most_seq_cst>(*this, seq_cst_).is_acyclic();
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
