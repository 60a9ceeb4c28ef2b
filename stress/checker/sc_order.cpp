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
//
// It had none before the last event came. That event, E, is followed by nothing but what comes
// later in the coherence order of its location. So there is a cycle only if one of these leads back
// to E, or to a fence that happens before E. What follows is collected thread by thread, for who
// comes before an operation comes before the rest of its thread; and location by location,
// downwards. So every operation is looked at once.

#include <algorithm>
#include <array>

#include "stress/checker/graph.hpp"

namespace irt::checker {

namespace {

class Followers {
 public:
  Followers(const Graph& graph, unsigned threads) : graph_(graph), threads_(threads) {
    ++question_;
    locations_.resize(std::max(locations_.size(), graph.locations()));
    numbers_.resize(std::max(numbers_.size(), graph.size()));
    work_.clear();
    for (unsigned t = 0; t < threads_; ++t) {
      operations_[t] = graph.thread(t).seq_cst.size();
      accesses_[t] = graph.thread(t).events.size();
      fences_ = fences_ || !graph.thread(t).seq_cst_fences.empty();
    }
  }

  /// Whether what follows `event` leads back to it.
  bool lead_back_to(const Event& event) {
    bool any = false;
    for (unsigned t = 0; t < threads_; ++t) {
      forbidden_[t] = fences_before(event, t);
      any = any || forbidden_[t] != 0;
    }
    if (event.order == Order::seq_cst) forbidden_[event.thread] = event.node + std::size_t{1};
    if (!any && event.order != Order::seq_cst) return false;
    from_access(event);
    while (!work_.empty() && !closed_) {
      const Range range = work_.back();
      work_.pop_back();
      from_operations(range);
    }
    return closed_;
  }

 private:
  /// Operations of a thread, by their numbers among its seq_cst ones.
  struct Range {
    unsigned thread;
    std::size_t begin, end;
  };
  /// How far down a location's coherence order everything is known to follow.
  struct Seen {
    std::uint64_t question = 0;       ///< for which all this is
    std::size_t place = 0;            ///< all stores from here on ...
    bool reads = false;               ///< ... and the reads of the one before
    std::vector<EventId> first_read;  ///< of each store: the latest; the others follow by numbers_
  };

  /// The fences of thread `t` that happen before `event`: the number behind the last one.
  [[nodiscard]] std::size_t fences_before(const Event& event, unsigned t) const {
    const auto& operations = graph_.thread(t).seq_cst;
    const auto& fences = graph_.thread(t).seq_cst_fences;
    const auto end = std::ranges::partition_point(fences, [&](std::uint16_t fence) {
      return happens_before(graph_.event(operations[fence]), event.after);
    });
    return end == fences.begin() ? 0 : *(end - 1) + std::size_t{1};
  }

  /// Everything of `thread` from that operation on follows.
  void reach(unsigned thread, std::size_t operation) {
    if (operation >= operations_[thread]) return;
    work_.push_back({thread, operation, operations_[thread]});
    operations_[thread] = operation;
    closed_ = closed_ || operation < forbidden_[thread];
  }

  void from_operations(const Range& range) {
    const std::vector<EventId>& mine = graph_.thread(range.thread).seq_cst;
    const Event& first = graph_.event(mine[range.begin]);
    for (unsigned t = 0; t < threads_; ++t) {
      if (t == range.thread) continue;
      const std::vector<EventId>& theirs = graph_.thread(t).seq_cst;
      const auto end = theirs.begin() + static_cast<std::ptrdiff_t>(operations_[t]);
      const auto next = std::partition_point(theirs.begin(), end, [&](EventId b) {
        return graph_.event(b).before.count[range.thread] <= first.index;
      });
      reach(t, static_cast<std::size_t>(next - theirs.begin()));
    }
    if (fences_) from_fences(range);
    for (std::size_t i = range.begin; i < range.end && !closed_; ++i)
      if (const Event& event = graph_.event(mine[i]); event.kind != EventKind::fence)
        from_access(event);
  }

  /// What the first fence in `range` happens before goes for those behind it, too.
  void from_fences(const Range& range) {
    const std::vector<std::uint16_t>& fences = graph_.thread(range.thread).seq_cst_fences;
    const auto found = std::ranges::lower_bound(fences, range.begin);
    if (found == fences.end() || *found >= range.end) return;
    const Event& fence = graph_.event(graph_.thread(range.thread).seq_cst[*found]);
    for (unsigned t = 0; t < threads_; ++t) {
      const std::vector<EventId>& events = graph_.thread(t).events;
      const auto end = events.begin() + static_cast<std::ptrdiff_t>(accesses_[t]);
      const auto next = std::partition_point(events.begin(), end, [&](EventId x) {
        return !happens_before(fence, graph_.event(x).after);
      });
      accesses_[t] = static_cast<std::size_t>(next - events.begin());
      for (auto x = next; x != end && !closed_; ++x)
        if (const Event& event = graph_.event(*x); event.reads || event.writes) from_access(event);
    }
  }

  Seen& look_at(std::uint32_t id) {
    Seen& seen = locations_[id];
    if (seen.question == question_) return seen;
    const Location& location = graph_.location(id);
    seen.question = question_;
    seen.reads = false;
    seen.place = location.stores.size();
    seen.first_read.assign(location.stores.size(), no_event);
    for (std::uint32_t place = 0; place < location.stores.size(); ++place)
      numbers_[location.stores[place]] = place;
    for (const EventId read : location.reads) {
      const Event& event = graph_.event(read);
      if (event.writes) continue;
      EventId& first = seen.first_read[numbers_[event.from]];
      numbers_[read] = first;
      first = read;
    }
    return seen;
  }

  /// Everything behind `event` in the coherence order of its location follows.
  void from_access(const Event& event) {
    Seen& seen = look_at(event.location);
    const std::vector<EventId>& stores = graph_.location(event.location).stores;
    const EventId store = event.writes ? graph_.id_of(event) : event.from;
    const std::size_t place = numbers_[store];
    // A plain write may have replaced what was there.
    if (place >= stores.size() || stores[place] != store) return;
    const auto reads_of = [&](std::size_t of) {
      for (EventId read = seen.first_read[of]; read != no_event; read = numbers_[read])
        to_access(graph_.event(read));
    };
    while (seen.place > place + 1) {
      --seen.place;
      to_access(graph_.event(stores[seen.place]));
      if (!seen.reads) reads_of(seen.place);
      seen.reads = false;
    }
    if (seen.place == place + 1 && event.writes && !seen.reads) {
      seen.reads = true;
      reads_of(place);
    }
  }

  /// `event` follows, or the fences that it happens before.
  void to_access(const Event& event) {
    if (event.order == Order::seq_cst) reach(event.thread, event.node);
    if (!fences_) return;
    for (unsigned t = 0; t < threads_; ++t) {
      const auto& operations = graph_.thread(t).seq_cst;
      const auto& fences = graph_.thread(t).seq_cst_fences;
      const auto next = std::ranges::partition_point(fences, [&](std::uint16_t f) {
        return !happens_before(event, graph_.event(operations[f]).after);
      });
      if (next != fences.end()) reach(t, *next);
    }
  }

  // Kept from one question to the next for their memory only.
  static inline std::uint64_t question_ = 0;
  static inline std::vector<Seen> locations_;
  /// Of a store: its place. Of a load: the next one of the same store.
  static inline std::vector<EventId> numbers_;
  static inline std::vector<Range> work_;

  const Graph& graph_;
  unsigned threads_;
  /// Of each thread: what follows begins with this operation, and with this event after a fence.
  std::array<std::size_t, max_threads> operations_{}, accesses_{};
  std::array<std::size_t, max_threads> forbidden_{};  ///< what comes before this may not follow
  bool fences_ = false;                               ///< there are any
  bool closed_ = false;
};

}  // namespace

bool Graph::keeps_seq_cst_order(const Event& event) const {
  return (!event.reads && !event.writes) || seq_cst_ < 2 ||
         !Followers(*this, static_cast<unsigned>(threads_.size())).lead_back_to(event);
}

bool Graph::allows(Event& event, std::uint32_t id, std::size_t place) {
  const bool reads = event.kind != EventKind::store;
  // What reads the newest store or becomes it comes after everything: nothing that was in order can
  // be put out of order by it, so only other places need the test.
  if ((seq_cst_ == 0 && !on_x86_) || place + (reads ? 1 : 0) == locations_[id].stores.size())
    return true;
  const Event saved = event;
  ThreadClocks& mine = threads_[event.thread];
  const Clock now = mine.now;
  const Clock causes = mine.causes;
  const Clock pending = mine.pending;
  if (event.kind == EventKind::modify)
    finish_modify(event, id, place, 0);
  else if (reads)
    finish_load(event, id, place);
  else
    finish_store(event, id, place, 0);
  const bool allowed = keeps_orders(event);
  --count_;
  mine.now = now;
  mine.causes = causes;
  mine.pending = pending;
  mine.events.pop_back();
  if (event.order == Order::seq_cst) {
    mine.seq_cst.pop_back();
    --seq_cst_;
  }
  Location& location = locations_[id];
  if (reads) location.reads.pop_back();
  if (event.kind != EventKind::load)
    location.stores.erase(location.stores.begin() +
                          static_cast<std::ptrdiff_t>(reads ? place + 1 : place));
  event = saved;
  return allowed;
}

}  // namespace irt::checker
