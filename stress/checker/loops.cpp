#include "stress/checker/loops.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace irt::checker {

EventId source_of(const Graph& graph, EventId store) {
  const Event* event = &graph.event(store);
  while (event->reads && event->read == event->written) {
    store = event->from;
    event = &graph.event(store);
  }
  return store;
}

bool is_newest(const Graph& graph, EventId store) {
  return source_of(graph, graph.location(graph.event(store).location).stores.back()) == store;
}

void Loops::begin() {
  for (Thread& thread : threads_) {
    std::vector<Visit> visits = std::move(thread.visits);
    std::vector<const void*> unusual = std::move(thread.unusual);
    visits.clear();
    unusual.clear();
    thread = Thread{};
    thread.visits = std::move(visits);
    thread.unusual = std::move(unusual);
  }
}

bool Loops::is_head(const void* pc) const {
  return std::ranges::binary_search(heads_, pc);
}

Loops::Visit* Loops::find_visit(const void* pc) {
  std::vector<Visit>& visits = mine().visits;
  const auto visit = std::ranges::find(visits, pc, &Visit::pc);
  return visit != visits.end() ? &*visit : nullptr;
}

void Loops::wait(const void* pc, bool assumed) {
  if (assumed) {
    turns_.mine().assumed = true;
    ++assumed_waits_;
  }
  turns_.wait(0, pc);
}

void Loops::enter(const void* pc) {
  if (state_.phase != Phase::parallel) return;
  Thread& me = mine();
  Visit* const visit = find_visit(pc);
  // What begins a loop is the same throughout an execution.
  const bool head = visit != nullptr ? visit->hashed : is_head(pc);
  // Now, for other cores may run before the load is made and leave their registers.
  if (head) me.entry_hash = state_.hash_of_core();
  if (visit == nullptr || me.insists != nullptr) return;
  const bool settled = state_.strategy->expects_more(state_.current());
  const bool repeats = visit->effects == me.effects;
  bool certain = false;
  if (repeats) {
    if (!head && visit->count >= 2 && !settled) {
      // From now on the first visit is hashed too, which shortens every later execution.
      heads_.insert(std::ranges::lower_bound(heads_, pc), pc);
      state_.conclusion.stop(Outcome::restart);
    }
    certain = head && visit->hash == me.entry_hash;
  }
  // A loop that writes may do so for a purpose, and is given more time.
  const std::uint32_t patience = (repeats ? 1 : 4) * state_.limits.same_reads + visit->wait_at;
  if (!certain && visit->count < patience) return;
  const std::uint32_t round_began = visit->read;
  const bool first_time = visit->wait_at == 0;
  if (!certain || settled) visit->wait_at = visit->count;
  const bool asks = settled ? state_.strategy->expects_choice(state_.current(), pc)
                            : !certain && !never_gives_up_.contains(pc);
  if (first_time && asks && chosen(pc)) {
    me.insists = pc;
    me.round_began = round_began;
    return;
  }
  if (settled) return;
  me.round_began = round_began;
  if (state_.strategy->resumes_waiting() && !sees_newest(state_.current()) && !visit->refreshed) {
    visit->refreshed = true;
    turns_.mine().fresh_reads = me.reads - me.round_began + 1;
    return;
  }
  wait(pc, !certain);
}

// What a loop read before its last round no longer matters to it: only what the round itself read
// can let it go on. One load may have been made at many places in it, so its reads are asked, not
// the loads.
bool Loops::sees_newest(unsigned thread) const {
  const Thread& t = threads_[thread];
  const Graph& graph = state_.graph;
  const auto& events = graph.thread(thread).events;
  auto left = t.reads >= t.round_began ? t.reads - t.round_began + 1 : 0;
  for (auto id = events.rbegin(); left != 0 && id != events.rend(); ++id) {
    const Event& event = graph.event(*id);
    if (!event.reads || event.blocked) continue;
    --left;
    if (!is_newest(graph, source_of(graph, event.from))) return false;
  }
  return true;
}

EventId Loops::insisted_on(const void* pc) {
  const Thread& me = mine();
  if (me.insists == nullptr) return no_event;
  const Visit* visit = find_visit(pc);
  return visit != nullptr && visit->read >= me.round_began ? visit->store : no_event;
}

EventId Loops::worn_out(const void* pc) {
  const Visit* visit = find_visit(pc);
  if (visit == nullptr || visit->count < state_.limits.same_reads) return no_event;
  return is_newest(state_.graph, visit->from) ? no_event : visit->from;
}

bool Loops::must_be_fresh() {
  std::uint32_t& left = turns_.mine().fresh_reads;
  return left != 0 && left-- != 0;
}

void Loops::note_read(const void* pc, EventId store) {
  if (state_.phase == Phase::parallel) note_visit(pc, store);
  Thread& me = mine();
  const Event& event = state_.graph.event(store);
  if (event.kind == EventKind::initial || event.thread == state_.current() ||
      store <= me.newest_read)
    return;
  me.newest_read = store;
  me.news_since = state_.events_of(state_.current());
}

void Loops::note_visit(const void* pc, EventId store) {
  Thread& me = mine();
  Visit* visit = find_visit(pc);
  if (visit == nullptr) visit = &me.visits.emplace_back(Visit{.pc = pc, .hashed = is_head(pc)});
  const EventId from = source_of(state_.graph, store);
  if (visit->from != from) {
    visit->count = visit->wait_at = 0;
    visit->refreshed = false;
  }
  visit->hash = me.entry_hash;
  visit->from = from;
  visit->store = store;
  visit->effects = me.effects;
  visit->read = ++me.reads;
  ++visit->count;
}

// A loop that tries a lock again and again writes all the time, so that only its lack of news tells
// it from work.
void Loops::expect_news(const void* pc) {
  Thread& me = mine();
  const std::size_t events = state_.events_of(state_.current());
  if (events < me.news_since + state_.limits.events_without_news || me.insists != nullptr ||
      state_.strategy->expects_more(state_.current()))
    return;
  me.news_since = events;
  const Visit* visit = find_visit(pc);
  me.round_began = visit != nullptr ? visit->read : me.reads + 1;
  wait(pc, true);
}

// A thread that has made too many steps makes no more that count. If the others may still change
// something they come first; if none of them can, it runs on by itself, unobserved, and is endless
// or not.
bool Loops::goes_on(const void* pc) {
  const unsigned thread = state_.current();
  const auto used_up = [this](unsigned t) {
    return state_.events_of(t) >= state_.limits.events_per_thread;
  };
  while (state_.phase == Phase::parallel && used_up(thread)) {
    if (mine().insists != nullptr) {
      // It does not give up within what is looked at: from now on it is taken to wait.
      never_gives_up_.insert(mine().insists);
      state_.conclusion.stop(Outcome::restart);
    }
    bool others_could = false;
    bool others_may = false;
    for (unsigned other = 0; other < state_.threads; ++other) {
      const Turns::Thread& o = turns_.of(other);
      if (other == thread || o.done || o.unborn || (o.waiting && !o.assumed)) continue;
      others_may = true;
      others_could = others_could || !used_up(other);
    }
    if (!others_could) {
      if (others_may || state_.strategy->expects_more(thread))
        state_.conclusion.give_up(
            fmt::format("a thread makes more than {} steps", state_.limits.events_per_thread));
      alone_.begin();
      return false;
    }
    turns_.mine().assumed = true;
    mine().round_began = 0;
    turns_.wait(0, pc);
  }
  return state_.phase != Phase::endless;
}

bool Loops::chosen(const void* pc) {
  if (state_.phase != Phase::parallel) return false;
  turns_.reach(0, false);
  return goes_on(pc) && state_.choose(2, pc) != 0;
}

bool Loops::chosen_once(const void* pc) {
  std::vector<const void*>& unusual = mine().unusual;
  if (std::ranges::find(unusual, pc) != unusual.end() || !chosen(pc)) return false;
  unusual.push_back(pc);
  note_effect();  // that a loop comes by again is not for want of a store
  return true;
}

}  // namespace irt::checker
