#include "stress/checker/dpor.hpp"

#include <algorithm>
#include <bit>

#include "stress/checker/coherence.hpp"
#include "stress/checker/execution_state.hpp"

namespace irt::checker {

bool Dpor::begin() {
  std::optional<Work> next = frontier_.next();
  if (!next) return false;
  current_ = std::move(*next);
  position_ = 0;
  stamp_ = 0;
  cut_ = false;
  trace_.clear();
  events_.clear();
  symmetry_.begin();
  remaining_.assign(max_threads, 0);
  for (const Planned& planned : current_.plan) {
    ++remaining_[planned.thread];
    stamp_ = std::max({stamp_, planned.read_stamp, planned.write_stamp});
  }
  return true;
}

unsigned Dpor::choose_thread(ExecutionState&, std::uint32_t runnable, unsigned) {
  if (cut_) return virtual_cores::host;
  if (position_ == current_.plan.size()) return static_cast<unsigned>(std::countr_zero(runnable));
  const unsigned thread = current_.plan[position_].thread;
  return (runnable >> thread & 1U) != 0 ? thread : virtual_cores::host;
}

bool Dpor::expects_more(unsigned thread) const {
  return remaining_[thread] != 0;
}

bool Dpor::expects_choice(unsigned thread, const void* pc) const {
  for (std::size_t i = position_; i < current_.plan.size(); ++i)
    if (current_.plan[i].thread == thread) return current_.plan[i].choice == pc;
  return false;
}

std::optional<std::size_t> Dpor::planned_place(ExecutionState& state, Event& event,
                                               std::uint32_t location) {
  if (position_ == current_.plan.size()) return std::nullopt;
  const Graph& graph = state.graph;
  const EventId store = graph.find(current_.plan[position_].from, location);
  const auto place = store == no_event ? std::nullopt : find_place(graph, location, store);
  const std::size_t stores = event.kind == EventKind::store ? 1 : 0;
  if (place) return *place + stores;
  // The store is not made this time, or a racing plain write has ended the object it was made to.
  differs_ = cut_ = true;
  return graph.location(location).stores.size() - 1 + stores;
}

void Dpor::push(const Planned& last, bool verify) {
  Work work{trace_, verify};
  work.plan.push_back(last);
  frontier_.add(std::move(work));
}

// Whether an equal thread should be the one to read the store at `at`, or to store after it.
bool Dpor::forbids(const ExecutionState& state, const Event& event, std::uint32_t location,
                   std::size_t at, bool reads) const {
  const Graph& graph = state.graph;
  const Event& store = graph.event(graph.location(location).stores[at]);
  return symmetry_.forbids(graph, state.heap, event.thread, event.index, location, at,
                           reads ? &store.causes : nullptr,
                           [&](EventId id) { return find_place(graph, location, id); });
}

std::size_t Dpor::choose_read(ExecutionState& state, Event& event, std::uint32_t location,
                              std::span<const ReadOption> options) {
  const Graph& graph = state.graph;
  const Location& at = graph.location(location);
  std::size_t chosen = options.size();
  for (std::size_t i = 0; i < options.size(); ++i) {
    const ReadOption& option = options[i];
    if (option.taken) {
      // Two modifications cannot follow the same store, but this one may push the other on.
      Event alone = event;
      const Event& store = graph.event(at.stores[option.place]);
      alone.kind = EventKind::modify;
      alone.reads = alone.writes = true;
      alone.from = at.stores[option.place];
      alone.causes.join(store.causes);
      alone.causes.join(symmetry_.past(graph, event.thread, event.index));
      alone.read_stamp = stamp_ + 1;
      alone.write_stamp = stamp_ + 2;
      revisit(state, alone, location, option.place);
    } else if (chosen == options.size()) {
      chosen = i;
    } else if (!forbids(state, event, location, option.place, true)) {
      push({.from = graph.event(at.stores[option.place]).ref(),
            .read_stamp = stamp_ + 1,
            .thread = event.thread,
            .fresh = option.modifies},
           false);
    }
  }
  return chosen;
}

std::size_t Dpor::choose_place(ExecutionState& state, Event& event, std::uint32_t location,
                               std::span<const std::size_t> places) {
  const Graph& graph = state.graph;
  for (const std::size_t place : places.subspan(1)) {
    if (forbids(state, event, location, place - 1, false)) continue;
    push({.from = graph.event(graph.location(location).stores[place - 1]).ref(),
          .write_stamp = stamp_ + 1,
          .thread = event.thread},
         false);
  }
  return 0;
}

unsigned Dpor::choose_other(ExecutionState& state, Event& event, unsigned count) {
  if (position_ != current_.plan.size()) return current_.plan[position_].option;
  for (unsigned option = 1; option < count; ++option)
    if (!symmetry_.forbids_option(state.graph, event.thread, event.index, option))
      push({.choice = event.pc, .option = option, .read_stamp = stamp_ + 1, .thread = event.thread},
           false);
  return 0;
}

void Dpor::added(ExecutionState& state, const Event& made) {
  Graph& graph = state.graph;
  const EventId id = graph.id_of(made);
  Event& event = graph.event(id);
  if (symmetry_.any()) {
    graph.depend(event, symmetry_.past(graph, event.thread, event.index));
    symmetry_.added(graph, state.heap, event);
  }
  bool fresh = event.writes;
  bool last = false;
  if (position_ < current_.plan.size()) {
    const Planned& planned = current_.plan[position_++];
    --remaining_[event.thread];
    event.read_stamp = planned.read_stamp;
    event.write_stamp = planned.write_stamp;
    fresh = planned.fresh && event.writes;
    last = position_ == current_.plan.size();
  } else if (event.kind != EventKind::store) {
    event.read_stamp = ++stamp_;
  }
  if (event.writes && event.write_stamp == 0) event.write_stamp = ++stamp_;

  Planned planned{.choice = event.kind == EventKind::choice ? event.pc : nullptr,
                  .option = event.option,
                  .read_stamp = event.read_stamp,
                  .write_stamp = event.write_stamp,
                  .thread = event.thread};
  std::size_t after = 0;
  if (event.reads) {
    planned.from = graph.event(event.from).ref();
    after = event.writes ? place_of(graph, event.from) : 0;
  } else if (event.writes) {
    after = place_of(graph, id) - 1;
    planned.from = graph.event(graph.location(event.location).stores[after]).ref();
  }
  trace_.push_back(planned);
  events_.push_back(id);
  // The last two are new to the rest of a plan: a store, and the read that reads it now.
  if (last && current_.verify &&
      !(graph.keeps_orders(graph.event(*(events_.end() - 2))) && graph.keeps_orders(event))) {
    cut_ = true;
    return;
  }
  if (fresh) revisit(state, event, event.location, after);
}

/// One store's search for reads that could read it.
struct Dpor::Revisit {
  const Graph& graph;
  const Location& location;
  const Event& store;

  [[nodiscard]] bool is_store(const Event& event) const {
    return event.kind != EventKind::initial && event.thread == store.thread &&
           event.index == store.index;
  }
  /// Whether `event` is among what led to the store, the store itself left out.
  [[nodiscard]] bool in_prefix(const Event& event) const {
    return event.kind == EventKind::initial ||
           (event.index <= store.causes.count[event.thread] && !is_store(event));
  }
  [[nodiscard]] bool before(const Event& event, std::uint32_t stamp_of_event,
                            std::uint32_t stamp) const {
    return stamp_of_event <= stamp || in_prefix(event);
  }
  static std::uint32_t stamp_of(const Event& event) {
    return event.kind == EventKind::store ? event.write_stamp : event.read_stamp;
  }

  /// No store that was there by `stamp`, or led here, comes after `from` in modification order.
  [[nodiscard]] bool was_newest(const Location& at, EventId from, EventId except,
                                std::uint32_t stamp) const {
    for (std::size_t place = at.stores.size(); at.stores[--place] != from;) {
      const Event& later = graph.event(at.stores[place]);
      if (at.stores[place] == except || is_store(later)) continue;
      if (before(later, later.write_stamp, stamp)) return false;
    }
    return true;
  }

  /// Whether `event` was made in the dullest way, seen from where `store` is made. Only then may
  /// it be taken back here; otherwise another execution does it.
  [[nodiscard]] bool dullest(EventId id) const {
    const Event& event = graph.event(id);
    if (event.kind == EventKind::choice) return event.option == 0;
    if (event.kind == EventKind::fence) return true;
    const Location& at = graph.location(event.location);
    if (event.reads) {
      const Event& from = graph.event(event.from);
      if (is_store(from) || !before(from, from.write_stamp, event.read_stamp)) return false;
      if (!was_newest(at, event.from, event.writes ? id : no_event, event.read_stamp)) return false;
    }
    if (event.writes) {
      for (const EventId read : at.reads) {
        const Event& reader = graph.event(read);
        if (reader.from == id && before(reader, reader.read_stamp, event.write_stamp)) return false;
      }
      if (!was_newest(at, id, no_event, event.write_stamp)) return false;
    }
    return true;
  }
};

void Dpor::revisit(const ExecutionState& state, const Event& store, std::uint32_t id,
                   std::size_t after) {
  const Graph& graph = state.graph;
  const Location& location = graph.location(id);
  const Revisit search{graph, location, store};
  const bool modifies = store.reads;
  std::vector<bool> gone(graph.size());
  for (const EventId read_id : location.reads) {
    const Event& read = graph.event(read_id);
    if (read.settled || search.is_store(read) || search.in_prefix(read)) continue;
    if (!search.dullest(read_id)) continue;

    // What came after the read and did not lead to the store is taken back.
    gone.assign(graph.size(), false);
    gone[read_id] = true;
    bool allowed = true;
    for (std::size_t i = 0; i < events_.size() && allowed; ++i) {
      const Event& event = graph.event(events_[i]);
      if (events_[i] == read_id || search.is_store(event) || search.in_prefix(event) ||
          Revisit::stamp_of(event) <= read.read_stamp)
        continue;
      gone[events_[i]] = true;
      allowed = search.dullest(events_[i]);
    }
    if (!allowed) continue;

    // The stores that stay, and how far down the read and the store may go among them.
    std::vector<EventId> stays;
    for (const EventId s : location.stores)
      if (!gone[s] && !search.is_store(graph.event(s))) stays.push_back(s);
    const auto lowest_seen = [&](const Clock& past) {
      std::size_t lowest = stays.size() - 1;
      while (lowest > 0 && !happens_before(graph.event(stays[lowest]), past)) --lowest;
      for (const EventId other : location.reads) {
        const Event& reader = graph.event(other);
        if (gone[other] || search.is_store(reader) || !happens_before(reader, past)) continue;
        const auto place = std::ranges::find(stays, reader.from);
        if (place != stays.end())
          lowest = std::max(lowest, static_cast<std::size_t>(place - stays.begin()));
      }
      return lowest;
    };
    const auto parts_modification = [&](std::size_t place) {
      if (place == stays.size()) return false;
      const Event& next = graph.event(stays[place]);
      return next.reads && next.from == stays[place - 1];
    };
    const std::size_t read_floor = lowest_seen(read.before);

    // Whether equal threads should be those to store after `stays[at]` and to read that.
    const auto forbidden = [&](std::size_t at) {
      const auto place = [&](EventId s) -> std::optional<std::size_t> {
        const auto found = std::ranges::find(stays, s);
        if (found == stays.end()) return std::nullopt;
        const auto before = static_cast<std::size_t>(found - stays.begin());
        return before > at ? before + 1 : before;
      };
      const Clock* source = modifies ? &graph.event(stays[at]).causes : nullptr;
      return symmetry_.forbids(graph, state.heap, store.thread, store.index, id, at, source,
                               place) ||
             symmetry_.forbids(graph, state.heap, read.thread, read.index, id, at + 1,
                               &store.causes, place);
    };
    const auto offer = [&](Planned made) {
      Work work;
      work.verify = true;
      work.plan.reserve(trace_.size() + 2);
      for (std::size_t i = 0; i < trace_.size(); ++i)
        if (!gone[events_[i]] && !search.is_store(graph.event(events_[i])))
          work.plan.push_back(trace_[i]);
      work.plan.push_back(made);
      work.plan.push_back({.from = store.ref(),
                           .read_stamp = read.read_stamp,
                           .thread = read.thread,
                           .fresh = true});
      frontier_.add(std::move(work));
    };
    Planned made{
        .read_stamp = store.read_stamp, .write_stamp = store.write_stamp, .thread = store.thread};
    if (modifies) {
      const EventId source = location.stores[after];
      const auto place =
          static_cast<std::size_t>(std::ranges::find(stays, source) - stays.begin()) + 1;
      if (parts_modification(place) || place <= read_floor || forbidden(place - 1)) continue;
      made.from = graph.event(source).ref();
      offer(made);
    } else {
      const std::size_t lowest = std::max(lowest_seen(store.before), read_floor) + 1;
      for (std::size_t place = stays.size() + 1; place-- > lowest;) {
        if (parts_modification(place) || forbidden(place - 1)) continue;
        made.from = graph.event(stays[place - 1]).ref();
        offer(made);
      }
    }
  }
}

}  // namespace irt::checker
