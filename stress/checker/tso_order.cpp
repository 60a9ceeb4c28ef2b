// The rules of x86, besides those of C++: total store order (Owens, Sarkar and Sewell 2009, "A
// Better x86 Memory Model: x86-TSO"; as axioms in Alglave, Maranget and Tautschnig 2014, "Herding
// Cats").
//
// Stores are seen by all in one order; only a load may be made before an earlier store of its
// thread is, for that waits in the store buffer. An execution is possible if this relation has no
// cycle:
//   - program order, but from a store to later loads with nothing between them that empties the
//     buffer: a locked instruction (a read-modify-write, a failed one, a seq_cst store, which
//     compiles to one) or a seq_cst fence;
//   - from a store to who reads it in another thread;
//   - modification order, and from a read to the stores behind the one that it read.
// It had none before the last event came, so only a way back to that one is looked for.

#include "stress/checker/coherence.hpp"
#include "stress/checker/graph.hpp"

namespace irt::checker {

namespace {

bool empties_buffer(const Event& event) {
  return event.kind == EventKind::modify || event.failed ||
         (event.kind != EventKind::load && event.order == Order::seq_cst);
}

class WayBack {
 public:
  WayBack(const Graph& graph, const Event& to)
      : graph_(graph), to_(graph.id_of(to)), seen_(graph.size()) {}

  bool exists() {
    visit(to_);
    while (!open_.empty() && !closed_) {
      const EventId id = open_.back();
      open_.pop_back();
      visit(id);
    }
    return closed_;
  }

 private:
  void reach(EventId id) {
    closed_ = closed_ || id == to_;
    if (seen_[id]) return;
    seen_[id] = true;
    open_.push_back(id);
  }

  void visit(EventId id) {
    const Event& event = graph_.event(id);
    if (event.kind == EventKind::initial) return;
    const bool buffered = event.kind == EventKind::store && !empties_buffer(event);
    // Later ones of its thread: the next of each kind, for the rest follows from these.
    const std::vector<EventId>& events = graph_.thread(event.thread).events;
    bool load = !buffered;
    bool other = true;
    for (std::size_t i = event.index; i < events.size() && (load || other); ++i) {
      const Event& next = graph_.event(events[i]);
      const bool loads = next.kind == EventKind::load && !next.failed;
      if (!next.reads && !next.writes && !empties_buffer(next)) continue;
      bool& wanted = loads ? load : other;
      if (!wanted) continue;
      reach(events[i]);
      wanted = false;
    }
    if (!event.reads && !event.writes) return;
    const Location& location = graph_.location(event.location);
    const EventId store = event.writes ? id : event.from;
    const auto place = find_place(graph_, event.location, store);
    if (!place) return;  // a plain write has replaced what was there
    if (*place + 1 < location.stores.size()) reach(location.stores[*place + 1]);
    if (!event.writes) return;
    for (const EventId read : location.reads)
      if (graph_.event(read).from == id && graph_.event(read).thread != event.thread) reach(read);
  }

  const Graph& graph_;
  EventId to_;
  std::vector<bool> seen_;
  std::vector<EventId> open_;
  bool closed_ = false;
};

}  // namespace

bool Graph::keeps_total_store_order(const Event& event) const {
  return !WayBack(*this, event).exists();
}

}  // namespace irt::checker
