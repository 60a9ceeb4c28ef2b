// Loops that wait: known by their state, or taken for such after many rounds.

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "stress/checker/execution.hpp"

namespace irt::checker {

using virtual_cores::host;

// A loop that comes back to a load with the same registers and the same stack, having written
// nothing and read the same stores, will do so forever, until somebody writes. That is known for
// sure. A loop that carries a counter may give up in the end. So after many rounds there is a
// choice: it is taken to wait, and goes on when nobody else can, each in turn, until it ends or is
// seen to be endless; or it *insists* on what it has read until it gives up. What happens if it
// sees the news in a round between these is what happens if it sees them in one of the first, but
// for the counter.

std::uint64_t Execution::hash_of_core() const {
  const virtual_cores::Registers& r = virtual_cores::registers();
  if (r.stack_pointer == 0) return steps_.size();  // not known: like no other
  const auto mix = [](std::uint64_t hash, std::uint64_t word) {
    hash = (hash ^ word) * 0xFF51AFD7ED558CCD;
    return hash ^ hash >> 32U;
  };
  // Four at a time, each by itself, for a processor waits for the multiplication before.
  constexpr std::uint64_t seed = 0x9E3779B97F4A7C15;
  std::array<std::uint64_t, 4> hashes{mix(mix(seed, r.rbx), r.rbp), mix(mix(seed, r.r12), r.r13),
                                      mix(mix(seed, r.r14), r.r15), mix(seed, r.stack_pointer)};
  const auto word_at = [](std::uintptr_t at) {
    return *reinterpret_cast<const std::uint64_t*>(at);  // NOLINT(performance-no-int-to-ptr)
  };
  const std::uintptr_t end = stacks_[cores_.current()] + stack_bytes_;
  std::uintptr_t at = r.stack_pointer;
  for (; at + 32 <= end; at += 32)
#pragma GCC unroll 4
    for (unsigned i = 0; i < 4; ++i) hashes[i] = mix(hashes[i], word_at(at + 8 * i));
  for (; at < end; at += 8) hashes[0] = mix(hashes[0], word_at(at));
  std::uint64_t hash = seed;
  for (const std::uint64_t part : hashes) hash = mix(hash, part);
  return hash;
}

bool Execution::is_loop_head(const void* pc) const {
  return std::binary_search(loop_heads_.begin(), loop_heads_.end(), pc);
}

void Execution::check_loop(const void* pc) {
  if (phase_ != Phase::parallel) return;
  ThreadState& state = me();
  const auto visit = std::find_if(state.visits.begin(), state.visits.end(),
                                  [pc](const Visit& v) { return v.pc == pc; });
  // What begins a loop is the same throughout an execution.
  const bool head = visit != state.visits.end() ? visit->hashed : is_loop_head(pc);
  // Now, for other cores may run before the load is made and leave their registers.
  if (head) state.entry_hash = hash_of_core();
  if (visit == state.visits.end() || state.insists) return;
  const bool settled = strategy_->expects_more(cores_.current());
  const bool repeats = visit->effects == state.effects;
  bool certain = false;
  if (repeats) {
    if (!head && visit->count >= 2 && !settled) {
      // From now on the first visit is hashed too, which shortens every later execution.
      loop_heads_.insert(std::lower_bound(loop_heads_.begin(), loop_heads_.end(), pc), pc);
      stop(Outcome::restart);
    }
    certain = head && visit->hash == state.entry_hash;
  }
  // A loop that writes may do so for a purpose, and is given more time.
  const std::uint32_t patience = (repeats ? 1 : 4) * limits_.same_reads + visit->wait_at;
  if (!certain && visit->count < patience) return;
  const std::uint32_t round_began = visit->read;
  const bool first_time = visit->wait_at == 0;
  if (!certain || settled) visit->wait_at = visit->count;
  const bool asks = settled ? strategy_->expects_choice(cores_.current(), pc)
                            : !certain && !never_gives_up_.contains(pc);
  if (first_time && asks && chosen(pc)) {
    state.insists = pc;
    state.round_began = round_began;
    return;
  }
  if (settled) return;
  state.round_began = round_began;
  if (strategy_->resumes_waiting() && !sees_newest(cores_.current()) && !visit->refreshed) {
    visit->refreshed = true;
    state.fresh_reads = state.reads - state.round_began + 1;
    return;
  }
  if (!certain) {
    state.assumed = true;
    ++assumed_waits_;
  }
  wait_here(0, pc);
}

// A modification that puts back what was there, as of a lock that is tried again and again, is no
// news: the store that is meant is the one before.
EventId Execution::source_of(EventId store) const {
  const Event* event = &graph_.event(store);
  while (event->reads && event->read == event->written) {
    store = event->from;
    event = &graph_.event(store);
  }
  return store;
}

bool Execution::is_newest(EventId store) const {
  return source_of(graph_.location(graph_.event(store).location).stores.back()) == store;
}

// What a loop read before its last round no longer matters to it: only what the round itself read
// can let it go on. One load may have been made at many places in it, so its reads are asked, not
// the loads.
bool Execution::sees_newest(unsigned thread) const {
  const ThreadState& state = states_[thread];
  const auto& events = graph_.thread(thread).events;
  auto left = state.reads >= state.round_began ? state.reads - state.round_began + 1 : 0;
  for (auto id = events.rbegin(); left != 0 && id != events.rend(); ++id) {
    const Event& event = graph_.event(*id);
    if (!event.reads || event.blocked) continue;
    --left;
    if (!is_newest(source_of(event.from))) return false;
  }
  return true;
}

void Execution::note_visit(const void* pc, EventId from) {
  if (phase_ != Phase::parallel) return;
  const EventId store = from;
  from = source_of(from);
  ThreadState& state = me();
  auto visit = std::find_if(state.visits.begin(), state.visits.end(),
                            [pc](const Visit& v) { return v.pc == pc; });
  if (visit == state.visits.end()) {
    state.visits.push_back({.pc = pc, .hashed = is_loop_head(pc)});
    visit = state.visits.end() - 1;
  }
  if (visit->from != from) {
    visit->count = visit->wait_at = 0;
    visit->refreshed = false;
  }
  visit->hash = state.entry_hash;
  visit->from = from;
  visit->store = store;
  visit->effects = state.effects;
  visit->read = ++state.reads;
  ++visit->count;
}

// A loop that tries a lock again and again writes all the time, so that only its lack of news tells
// it from work.
void Execution::check_news(const void* pc) {
  ThreadState& state = me();
  const std::size_t events = graph_.thread(cores_.current()).events.size();
  if (events < state.news_since + limits_.events_without_news || state.insists != nullptr ||
      strategy_->expects_more(cores_.current()))
    return;
  state.news_since = events;
  const auto visit = std::find_if(state.visits.begin(), state.visits.end(),
                                  [pc](const Visit& v) { return v.pc == pc; });
  state.round_began = visit != state.visits.end() ? visit->read : state.reads + 1;
  state.assumed = true;
  ++assumed_waits_;
  wait_here(0, pc);
}

void Execution::note_news(EventId from) {
  ThreadState& state = me();
  const Event& store = graph_.event(from);
  if (store.kind == EventKind::initial || store.thread == cores_.current() ||
      from <= state.newest_read)
    return;
  state.newest_read = from;
  state.news_since = graph_.thread(cores_.current()).events.size();
}

// --- Code without events ----------------------------------------------------------------------

namespace {

constexpr double longest_computation = 5;

}  // namespace

bool Execution::patient(double seconds) const {
  return seconds < longest_computation && !deadline_.passed();
}

void Execution::spins(const void* pc, bool endless, double seconds) {
  if (endless) {
    me().waiting = true;
    me().wait_pc = pc;
    report(FindingKind::livelock,
           fmt::format("{} loops at {{0}} for ever: it looks at no memory but its stack, and that "
                       "and its registers have come back to what they were",
                       phase_ == Phase::parallel ? fmt::format("thread {}", cores_.current())
                                                 : "the only thread"),
           {pc});
  }
  constexpr double worth_a_word = 0.04;
  if (incomplete_.empty() && seconds > worth_a_word) incomplete_at_ = pc;
  out_of_time_ = deadline_.passed();
  if (out_of_time_) stop(Outcome::cut);
  give_up(fmt::format("{} s in one call without an event", longest_computation));
}

// --- Limits, and code that runs alone ---------------------------------------------------------

void Execution::give_up(std::string why) {
  if (incomplete_.empty()) incomplete_ = std::move(why);
  stop(Outcome::cut);
}

// A thread that has made too many steps makes no more that count. If the others may still change
// something they come first; if none of them can, it runs on by itself, unobserved, and is endless
// or not.
void Execution::check_limit(const void* pc) {
  const unsigned thread = cores_.current();
  const auto used_up = [this](unsigned t) {
    return graph_.thread(t).events.size() >= limits_.events_per_thread;
  };
  if (phase_ != Phase::parallel || !used_up(thread)) return;
  ThreadState& state = states_[thread];
  if (state.insists != nullptr) {
    // It does not give up within what is looked at: from now on it is taken to wait.
    never_gives_up_.insert(state.insists);
    stop(Outcome::restart);
  }
  bool others_could = false;
  bool others_may = false;
  for (unsigned other = 0; other < main_; ++other) {
    const ThreadState& o = states_[other];
    if (other == thread || o.done || (o.waiting && !o.assumed)) continue;
    others_may = true;
    others_could = others_could || !used_up(other);
  }
  if (others_could) {
    state.assumed = true;
    state.round_began = 0;
    wait_here(0, pc);
    return check_limit(pc);
  }
  if (others_may || strategy_->expects_more(thread))
    give_up(fmt::format("a thread makes more than {} steps", limits_.events_per_thread));
  phase_ = Phase::endless;
  alone_.begin();
  looks_ = 0;
}

void Execution::conclude_alone(bool endless, const void* pc) {
  if (phase_ != Phase::endless)
    report(FindingKind::livelock,
           "the only thread loops at {0} for ever: it comes back to the state that it was in",
           {pc});
  const auto shared = [this](std::uintptr_t address) {
    return heap_.cell(address).toucher != cores_.current() + 1;
  };
  if (!endless || !alone_.restored(shared))
    give_up(fmt::format("a thread makes more than {} steps", limits_.events_per_thread));
  phase_ = Phase::parallel;
  ThreadState& state = me();
  state.endless = state.waiting = true;
  state.assumed = false;
  state.wait_location = 0;
  state.wait_pc = pc;
  cores_.switch_to(host);
}

// Called at each read of the only thread.
void Execution::look_alone(const void* pc) {
  ++looks_;
  check_time();
  if (virtual_cores::registers().stack_pointer != 0 &&
      alone_.repeats(hash_of_core() ^ reinterpret_cast<std::uintptr_t>(pc)))
    conclude_alone(true, pc);
  if (looks_ <= limits_.looks) return;
  if (phase_ == Phase::endless) conclude_alone(true, pc);
  if (alone_.restored([](std::uintptr_t) { return true; }))
    report(
        FindingKind::livelock,
        fmt::format("the only thread loops at {{0}}: in {} looks nothing but counters of its own "
                    "has changed",
                    looks_),
        {pc});
  alone_.begin();
  looks_ = 0;
}

}  // namespace irt::checker
