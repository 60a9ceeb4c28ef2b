#include "stress/checker/execution.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace irt::checker {

using virtual_cores::Access;
using virtual_cores::host;
using virtual_cores::Operation;
using virtual_cores::Wake;

namespace {

// Where a futex keeps its sleepers: an address that no program has.
std::uintptr_t sleepers_of(std::uintptr_t address) {
  return address | (std::uintptr_t{1} << 63U);
}

// What S and W of a shape write and read.
constexpr std::uintptr_t signal_address = (std::uintptr_t{1} << 63U) | 64U;

Value mask_of(std::uint32_t size) {
  return size == sizeof(Value) ? ~Value{0} : (Value{1} << (8 * size)) - 1;
}

// A futex's sleepers: thread numbers plus one, a byte each, the oldest lowest.
Value with_sleeper(Value sleepers, unsigned thread) {
  unsigned at = 0;
  while ((sleepers >> (8 * at) & 0xFF) != 0) ++at;
  return sleepers | Value{thread + 1} << (8 * at);
}
bool is_sleeper(Value sleepers, unsigned thread) {
  for (; sleepers != 0; sleepers >>= 8)
    if ((sleepers & 0xFF) == thread + 1) return true;
  return false;
}
Value without_oldest(Value sleepers, unsigned count) {
  return count >= sizeof(Value) ? 0 : sleepers >> (8 * count);
}
// Without `thread`; if a wake-up has already taken it out, that goes to the next one.
Value without_sleeper(Value sleepers, unsigned thread) {
  if (!is_sleeper(sleepers, thread)) return without_oldest(sleepers, 1);
  Value result = 0;
  for (unsigned at = 0; sleepers != 0; sleepers >>= 8)
    if ((sleepers & 0xFF) != thread + 1) result |= (sleepers & 0xFF) << (8 * at++);
  return result;
}
unsigned sleeper_count(Value sleepers) {
  unsigned count = 0;
  for (; sleepers != 0; sleepers >>= 8) ++count;
  return count;
}

}  // namespace

Execution* Execution::current_execution_ = nullptr;

Execution::Execution(const Scenario& scenario, const Limits& limits)
    : scenario_(scenario),
      limits_(limits),
      main_(static_cast<unsigned>(scenario.threads.size())),
      cores_(*this, main_ + 1),
      graph_(main_ + 1),
      heap_(main_ + 1),
      states_(main_ + 1) {}

Outcome Execution::run(Strategy& strategy) {
  strategy_ = &strategy;
  current_execution_ = this;
  graph_.clear();
  heap_.clear();
  steps_.clear();
  finding_.reset();
  froze_ = false;
  stores_ = touches_ = 0;
  outcome_ = Outcome::complete;
  for (ThreadState& state : states_) {
    std::vector<Visit> visits = std::move(state.visits);
    visits.clear();
    state = ThreadState{};
    state.visits = std::move(visits);
  }
  if (scenario_.module != nullptr) scenario_.module->reset_globals();

  const auto enter = [](void* work) { (*static_cast<const std::function<void()>*>(work))(); };
  const auto arm = [&](unsigned core, const std::function<void()>& work) {
    cores_.arm(core, enter, const_cast<std::function<void()>*>(&work));
  };
  if (scenario_.prepare) {
    phase_ = Phase::prepare;
    arm(main_, scenario_.prepare);
    cores_.run(main_);
  }
  if (outcome_ == Outcome::complete) {
    phase_ = Phase::parallel;
    graph_.tick(main_);
    for (unsigned thread = 0; thread < main_; ++thread) {
      graph_.order(main_, thread);
      arm(thread, scenario_.threads[thread]);
    }
    const unsigned first = strategy.choose_thread(*this, runnable(), host);
    if (first == host)
      outcome_ = Outcome::cut;
    else
      cores_.run(first);
    if (outcome_ == Outcome::complete && strategy.gives_up()) outcome_ = Outcome::cut;
    if (outcome_ == Outcome::complete) outcome_ = after_threads();
  }
  if (outcome_ == Outcome::complete) {
    for (unsigned thread = 0; thread < main_; ++thread) {
      graph_.tick(thread);
      graph_.order(thread, main_);
    }
    if (scenario_.finish) {
      phase_ = Phase::finish;
      arm(main_, scenario_.finish);
      cores_.run(main_);
    }
  }
  phase_ = Phase::idle;
  if (outcome_ == Outcome::complete && scenario_.judge) {
    if (auto wrong = scenario_.judge(*this)) {
      finding_ = Finding{FindingKind::wrong_outcome, std::move(*wrong), {}};
      outcome_ = Outcome::found;
    }
  }
  if (outcome_ == Outcome::complete && limits_.leaks && !frozen_ && scenario_.finish) {
    for (const Block& block : heap_.blocks()) {
      if (block.freed) continue;
      finding_ = Finding{
          FindingKind::leak,
          "a block of " + std::to_string(block.size) + " bytes, allocated at {0}, is never freed",
          {block.allocated_at}};
      outcome_ = Outcome::found;
      break;
    }
  }
  current_execution_ = nullptr;
  strategy.end(*this, outcome_);
  return outcome_;
}

// --- Who runs -------------------------------------------------------------------------------

std::uint32_t Execution::runnable() const {
  std::uint32_t mask = 0;
  for (unsigned thread = 0; thread < main_; ++thread) {
    const ThreadState& state = states_[thread];
    if (state.done) continue;
    if (state.waiting && (!strategy_->resumes_waiting() || stores_ <= state.waits_since)) continue;
    mask |= 1U << thread;
  }
  return mask;
}

void Execution::stop(Outcome outcome) {
  outcome_ = outcome;
  cores_.switch_to(host);
  std::abort();
}

void Execution::report(FindingKind kind, std::string text, std::vector<const void*> places) {
  finding_ = Finding{kind, std::move(text), std::move(places)};
  stop(Outcome::found);
}

std::string Execution::stalled() const {
  return "with thread " + std::to_string(frozen_->first) + " stopped after " +
         std::to_string(frozen_->second) + " steps, ";
}

// A loop that tries a lock again and again writes all the time, so that only its lack of news tells
// it from work.
void Execution::check_news(const void* pc) {
  ThreadState& state = me();
  const std::size_t events = graph_.thread(cores_.current()).events.size();
  if (events < state.news_since + limits_.events_without_news ||
      strategy_->expects_more(cores_.current()))
    return;
  state.news_since = events;
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

void Execution::check_limit(const void* pc) {
  if (graph_.thread(cores_.current()).events.size() >= limits_.events_per_thread)
    report(frozen_ ? FindingKind::blocked_by_stalled_thread : FindingKind::livelock,
           (frozen_ ? stalled() : "") + "a thread does not come to an end within " +
               std::to_string(limits_.events_per_thread) + " steps; it is at {0}",
           {pc});
}

void Execution::reach(std::uintptr_t address, bool writes) {
  ThreadState& state = me();
  if (phase_ != Phase::parallel) return;
  if (frozen_ && frozen_->first == cores_.current() &&
      graph_.thread(frozen_->first).events.size() >= frozen_->second) {
    froze_ = state.done = true;
    go_elsewhere();
  }
  if (!state.started) {  // it was chosen to begin, and nothing has happened since
    state.started = true;
    return;
  }
  state.pending = address;
  state.pending_writes = writes;
  const unsigned next = strategy_->choose_thread(*this, runnable(), cores_.current());
  if (next == host) stop(Outcome::cut);
  cores_.switch_to(next);
}

void Execution::go_elsewhere() {
  const unsigned next = finished(host);
  if (next == host) cores_.switch_to(host);
  cores_.switch_to(next);
}

unsigned Execution::finished(unsigned core) {
  if (phase_ != Phase::parallel) return host;
  if (core != host) states_[core].done = true;
  std::uint32_t mask = runnable();
  if (mask == 0) {
    // Another execution goes on where this one has a thread wait for a store that is there by now.
    const bool goes_on = std::any_of(states_.begin(), states_.end() - 1, [this](const auto& s) {
      return !s.done && s.waiting && !s.assumed && stores_ > s.waits_since;
    });
    if (goes_on) return host;
    // Nobody else: a loop that only looked like waiting may still come to an end by itself.
    for (unsigned thread = 0; thread < main_ && mask == 0; ++thread)
      if (!states_[thread].done && states_[thread].assumed) {
        states_[thread].assumed = states_[thread].waiting = false;
        // But not by reading again and again what is old by now: that would be unfair.
        states_[thread].fresh_reads = static_cast<std::uint32_t>(limits_.events_per_thread);
        mask = 1U << thread;
      }
    if (mask == 0) return host;
  }
  const unsigned next = strategy_->choose_thread(*this, mask, cores_.current());
  if (next == host) outcome_ = Outcome::cut;
  return next;
}

void Execution::wait_here(std::uint32_t location, const void* pc) {
  ThreadState& state = me();
  if (phase_ != Phase::parallel) {
    report(FindingKind::deadlock, "the only thread waits at {0} for a store that nobody makes",
           {pc});
  }
  state.waiting = true;
  state.wait_location = location;
  state.waits_since = stores_;
  state.wait_pc = pc;
  go_elsewhere();
  state.waiting = false;
}

Outcome Execution::after_threads() {
  if (std::all_of(states_.begin(), states_.end() - 1, [](const ThreadState& s) { return s.done; }))
    return Outcome::complete;
  // Some wait. It is for good only if each has seen the newest store of all it waits for.
  for (unsigned thread = 0; thread < main_; ++thread) {
    const ThreadState& state = states_[thread];
    if (state.done) continue;
    if (state.timed) return Outcome::blocked;
    if (state.wait_location != 0) {
      const std::vector<EventId>& events = graph_.thread(thread).events;
      if (events.empty()) continue;
      const Event& last = graph_.event(events.back());
      if (last.blocked && !is_newest(source_of(last.from))) return Outcome::blocked;
    } else {
      for (const Visit& visit : state.visits)
        if (visit.effects == state.effects && !is_newest(visit.from)) return Outcome::blocked;
    }
  }
  explain_standstill();
  return Outcome::found;
}

void Execution::explain_standstill() {
  Finding finding{FindingKind::deadlock, "", {}};
  for (unsigned thread = 0; thread < main_; ++thread) {
    const ThreadState& state = states_[thread];
    if (state.done) continue;
    const std::string place = "{" + std::to_string(finding.places.size()) + "}";
    finding.places.push_back(state.wait_pc);
    if (!finding.text.empty()) finding.text += "; ";
    finding.text += "thread " + std::to_string(thread);
    if (state.wait_sleeps) {
      finding.text += " sleeps at " + place + " and nobody is left to wake it";
    } else if (state.wait_location != 0) {
      finding.text += " waits at " + place + " for a lock that is never released";
    } else {
      finding.text += " loops at " + place + " for a store that nobody makes";
      finding.kind = FindingKind::livelock;
    }
  }
  if (frozen_) {
    finding.kind = FindingKind::blocked_by_stalled_thread;
    finding.text = stalled() + finding.text;
  }
  finding_ = finding;
}

void Execution::on_failure(const std::string& what, const void* pc) {
  finding_ = Finding{FindingKind::failure, pc != nullptr ? what + " at {0}" : what, {}};
  if (pc != nullptr) finding_->places.push_back(pc);
  stop(Outcome::found);
}

// --- Loops that wait ------------------------------------------------------------------------

// A loop that comes back to a load with the same registers and the same stack, having written
// nothing and read the same stores, will do so forever, until somebody writes. That is known for
// sure. A loop that carries a counter is only assumed to wait, after many rounds.

std::uint64_t Execution::hash_of_core() const {
  const virtual_cores::Registers& r = virtual_cores::registers();
  if (r.stack_pointer == 0) return steps_.size();  // not known: like no other
  std::uint64_t hash = 0x9E3779B97F4A7C15;
  const auto mix = [&hash](std::uint64_t word) {
    hash = (hash ^ word) * 0xFF51AFD7ED558CCD;
    hash ^= hash >> 32U;
  };
  for (const std::uint64_t word : {r.rbx, r.rbp, r.r12, r.r13, r.r14, r.r15, r.stack_pointer})
    mix(word);
  const std::uintptr_t end = cores_.stack_of(cores_.current()) + cores_.stack_bytes();
  for (std::uintptr_t at = r.stack_pointer; at < end; at += 8)
    mix(*reinterpret_cast<const std::uint64_t*>(at));  // NOLINT(performance-no-int-to-ptr)
  return hash;
}

void Execution::check_loop(const void* pc) {
  if (phase_ != Phase::parallel) return;
  ThreadState& state = me();
  // Now, for other cores may run before the load is made and leave their registers.
  if (loop_heads_.contains(pc)) state.entry_hash = hash_of_core();
  const auto visit = std::find_if(state.visits.begin(), state.visits.end(),
                                  [pc](const Visit& v) { return v.pc == pc; });
  if (visit == state.visits.end() || strategy_->expects_more(cores_.current())) return;
  const bool repeats = visit->effects == state.effects;
  bool certain = false;
  if (repeats) {
    if (!loop_heads_.contains(pc) && visit->count >= 2) {
      // From now on the first visit is hashed too, which shortens every later execution.
      loop_heads_.insert(pc);
      stop(Outcome::restart);
    }
    certain = visit->hashed && loop_heads_.contains(pc) && visit->hash == state.entry_hash;
  }
  // A loop that writes may do so for a purpose, and is given more time.
  const std::uint32_t patience = (repeats ? 1 : 4) * limits_.same_reads + visit->wait_at;
  if (!certain && visit->count < patience) return;
  if (strategy_->resumes_waiting()) {
    const bool stale = std::any_of(state.visits.begin(), state.visits.end(), [&](const Visit& v) {
      return v.effects == state.effects && !is_newest(v.from);
    });
    if (stale && !visit->refreshed) {
      visit->refreshed = true;
      state.fresh_reads = static_cast<std::uint32_t>(state.visits.size());
      return;
    }
  }
  if (!certain) {
    state.assumed = true;
    ++assumed_waits_;
    visit->wait_at = visit->count;
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

void Execution::note_visit(const void* pc, EventId from) {
  if (phase_ != Phase::parallel) return;
  from = source_of(from);
  ThreadState& state = me();
  auto visit = std::find_if(state.visits.begin(), state.visits.end(),
                            [pc](const Visit& v) { return v.pc == pc; });
  if (visit == state.visits.end()) {
    state.visits.push_back({.pc = pc});
    visit = state.visits.end() - 1;
  }
  if (visit->from != from) {
    visit->count = visit->wait_at = 0;
    visit->refreshed = false;
  }
  visit->hashed = loop_heads_.contains(pc);
  visit->hash = state.entry_hash;
  visit->from = from;
  visit->effects = state.effects;
  ++visit->count;
}

// --- Atomic accesses ------------------------------------------------------------------------

void Execution::record(const Event& event, std::size_t choice) {
  if (phase_ != Phase::parallel) return;
  steps_.push_back(
      {event.thread, static_cast<std::uint8_t>(event.kind), static_cast<std::uint16_t>(choice)});
  strategy_->added(*this, event);
}

void Execution::widen(std::uintptr_t address, std::uint32_t size) {
  // An access that crosses eight bytes, or is wider, takes the whole sixteen.
  const std::uintptr_t unit = address & ~std::uintptr_t{15};
  const bool eight = (address & 7U) + size <= 8 && widened_.count(unit) == 0;
  widened_[unit] = eight ? 8 : 16;
  stop(Outcome::restart);
}

Execution::Part Execution::part_at(std::uintptr_t address, std::uint32_t size, bool needs_value,
                                   const void*) {
  std::uintptr_t base = address;
  std::uint32_t whole = size;
  if (!widened_.empty()) {
    const auto wide = widened_.find(address & ~std::uintptr_t{15});
    if (wide != widened_.end()) {
      whole = std::max(size, wide->second);
      base = address & ~std::uintptr_t{whole - 1};
      if (address + size > base + whole) widen(address, 16);
    }
  }
  Part part{0, static_cast<unsigned>(8 * (address - base)), mask_of(size)};
  Cell& cell = heap_.cell(base);
  const auto covers = [&](std::uint32_t id) {
    const Location& l = graph_.location(id);
    return l.address < base + whole && base < l.address + l.size;
  };
  for (std::uint32_t link = cell.location; link != 0; link = next_location_[link - 1]) {
    if (!covers(link - 1)) continue;
    const Location& found = graph_.location(link - 1);
    if (found.address != base || found.size != whole)
      widen(std::min(found.address, base), std::max(found.size, whole));
    part.location = link - 1;
    const auto bytes = static_cast<std::uint8_t>(((1U << std::min(whole, 8U)) - 1) << (base & 7U));
    if ((cell.replaced & bytes) != 0) {
      cell.replaced = static_cast<std::uint8_t>(cell.replaced & ~bytes);
      graph_.reset_location(part.location, virtual_cores::read_memory(base, whole));
    }
    return part;
  }
  if (whole == 16 && heap_.cell(base + 8).location != 0) widen(address, 16);
  static_cast<void>(needs_value);
  const Value initial = base >> 63U != 0 ? 0 : virtual_cores::read_memory(base, whole);
  part.location = graph_.add_location(base, whole, initial);
  next_location_.resize(part.location);
  next_location_.push_back(cell.location);
  cell.location = part.location + 1;
  if (whole == 16) heap_.cell(base + 8).location = part.location + 1;
  if (on_own_stack(address)) stack_locations_ = true;
  return part;
}

void Execution::note_write(const Event& event, Value before) {
  ++stores_;
  const Location& location = graph_.location(event.location);
  if (event.written != before) ++me().effects;
  if (location.stores.back() == graph_.id_of(event) && location.address >> 63U == 0)
    virtual_cores::write_memory(location.address, location.size, event.written);
}

template <class Decide, class NewValue>
Value Execution::read_event(const Request& request, bool may_write, Decide decide,
                            NewValue new_value) {
  const unsigned thread = cores_.current();
  const bool real = request.address >> 63U == 0;
  for (;;) {
    check_limit(request.pc);
    check_news(request.pc);
    if (real) check_touch(request.address, request.size, may_write, true, request.pc);
    const Part part = part_at(request.address, request.size, true, request.pc);
    const std::uint32_t id = part.location;
    const auto value_at = [&](std::size_t place) {
      return graph_.event(graph_.location(id).stores[place]).written >> part.shift & part.mask;
    };
    const std::size_t newest = graph_.location(id).stores.size() - 1;
    Event& event = graph_.begin(EventKind::load, thread, request.success, request.pc);
    const auto prepare = [&](Meaning meaning) {
      event.kind = meaning == Meaning::modify ? EventKind::modify : EventKind::load;
      event.order = meaning == Meaning::modify ? request.success
                    : meaning == Meaning::load ? request.failure
                                               : Order::relaxed;
      event.blocked = meaning == Meaning::wait;
    };
    std::size_t place = newest;
    if (phase_ == Phase::parallel) {
      if (const auto planned = strategy_->planned_place(*this, event, id)) {
        place = *planned;
      } else {
        options_.clear();
        const bool fresh = me().fresh_reads != 0;
        if (fresh) --me().fresh_reads;
        std::size_t lowest = fresh ? newest : graph_.lowest_readable(thread, id);
        const auto before = std::find_if(me().visits.begin(), me().visits.end(),
                                         [&](const Visit& v) { return v.pc == request.pc; });
        if (before != me().visits.end() && before->count >= limits_.same_reads &&
            graph_.event(before->from).location == id && !is_newest(before->from))
          lowest = std::max(lowest, graph_.place_of(before->from) + 1);
        const bool verified = strategy_->wants_verified();
        for (std::size_t p = newest + 1; p-- > lowest;) {
          const Meaning meaning = decide(value_at(p));
          if (meaning == Meaning::wait && p != newest) continue;
          const bool modifies = meaning == Meaning::modify;
          const bool taken = modifies && !graph_.free_to_modify(graph_.location(id), p);
          prepare(meaning);
          if (!taken && verified && p != newest && !graph_.allows_read(event, id, p, modifies))
            continue;
          options_.push_back({p, modifies, meaning == Meaning::wait, taken});
        }
        if (strategy_->resumes_waiting()) {
          std::erase_if(options_, [](const ReadOption& o) { return o.taken; });
          if (options_.size() > 1)
            std::erase_if(options_, [](const ReadOption& o) { return o.waits; });
        }
        for (;;) {
          const std::size_t chosen = strategy_->choose_read(*this, event, id, options_);
          place = options_[chosen].place;
          prepare(decide(value_at(place)));
          if (verified || place == newest ||
              graph_.allows_read(event, id, place, options_[chosen].modifies))
            break;
          options_.erase(options_.begin() + static_cast<std::ptrdiff_t>(chosen));
        }
      }
    }
    const Value value = value_at(place);
    const Meaning meaning = decide(value);
    prepare(meaning);
    if (meaning == Meaning::wait) {
      if (phase_ == Phase::parallel && !strategy_->resumes_waiting()) {
        graph_.finish_load(event, id, place);
        record(event, newest - place);
      }
      wait_here(id + 1, request.pc);
      continue;
    }
    const Value whole = graph_.event(graph_.location(id).stores[place]).written;
    if (meaning == Meaning::modify) {
      const Value written = (whole & ~(part.mask << part.shift)) | (new_value(value) & part.mask)
                                                                       << part.shift;
      graph_.finish_modify(event, id, place, written);
      note_write(event, whole);
    } else {
      graph_.finish_load(event, id, place);
    }
    const EventId from = event.from;
    record(event, newest - place);
    note_visit(request.pc, from);
    note_news(from);
    return value;
  }
}

Order Execution::order_at(const void* pc, bool failure, EventKind kind, Order order) {
  if (!watches_orders_) return order;
  auto [place, fresh] = weakened_[failure ? 1 : 0].try_emplace(pc, order);
  if (fresh) order_sites_.push_back({pc, failure, kind, order});
  return place->second;
}

void Execution::weaken(const std::vector<std::pair<OrderSite, Order>>& changes) {
  watches_orders_ = watches_orders_ || !changes.empty();
  for (const auto& [site, order] : changes) weakened_[site.failure ? 1 : 0][site.pc] = order;
}

// Outside of the threads' time everything happens before or after everything else, so that a read
// finds what memory holds and nothing needs an event.
void Execution::step_alone(std::uintptr_t address, std::size_t size, bool writes, const void* pc) {
  if (observed()) check_touch(address, size, writes, true, pc);
}

Value Execution::load(const Access& access) {
  if (phase_ != Phase::parallel) {
    step_alone(access.address, access.size, false, access.pc);
    return Tenant::load(access);
  }
  check_loop(access.pc);
  reach(access.address, false);
  const Order order = order_at(access.pc, false, EventKind::load, access.order);
  return read_event(
      {access.address, access.size, access.pc, order, order}, false,
      [](Value) { return Meaning::load; }, [](Value value) { return value; });
}

Value Execution::modify(const Access& access, Operation operation, Value operand) {
  if (phase_ != Phase::parallel) {
    step_alone(access.address, access.size, true, access.pc);
    return Tenant::modify(access, operation, operand);
  }
  check_loop(access.pc);
  reach(access.address, true);
  const Order order = order_at(access.pc, false, EventKind::modify, access.order);
  return read_event(
      {access.address, access.size, access.pc, order, order}, true,
      [](Value) { return Meaning::modify; },
      [&](Value value) { return virtual_cores::apply(operation, value, operand, access.size); });
}

bool Execution::compare_exchange(const Access& access, Order failure, bool weak, Value& expected,
                                 Value desired) {
  if (phase_ != Phase::parallel) {
    step_alone(access.address, access.size, true, access.pc);
    return Tenant::compare_exchange(access, failure, weak, expected, desired);
  }
  check_loop(access.pc);
  reach(access.address, true);
  const bool fails = weak && limits_.weak_may_fail && other_choice(2, access.pc) != 0;
  const Value wanted = expected;
  expected = read_event(
      {access.address, access.size, access.pc,
       order_at(access.pc, false, EventKind::modify, access.order),
       order_at(access.pc, true, EventKind::modify, failure)},
      !fails,
      [&](Value value) { return value == wanted && !fails ? Meaning::modify : Meaning::load; },
      [&](Value) { return desired; });
  return expected == wanted && !fails;
}

void Execution::store(const Access& access, Value value) {
  if (phase_ != Phase::parallel) {
    step_alone(access.address, access.size, true, access.pc);
    return Tenant::store(access, value);
  }
  reach(access.address, true);
  check_touch(access.address, access.size, true, true, access.pc);
  check_limit(access.pc);
  const Part part = part_at(access.address, access.size, false, access.pc);
  const std::uint32_t id = part.location;
  const unsigned thread = cores_.current();
  if (graph_.location(id).size != access.size) {
    // A part of a wider location is put in place as if by a modification of the whole.
    read_event(
        {access.address, access.size, access.pc, access.order, access.order}, true,
        [](Value) { return Meaning::modify; }, [value](Value) { return value; });
    return;
  }
  Event& event =
      graph_.begin(EventKind::store, thread,
                   order_at(access.pc, false, EventKind::store, access.order), access.pc);
  const std::size_t last = graph_.location(id).stores.size();
  std::size_t place = last;
  if (phase_ == Phase::parallel) {
    if (const auto planned = strategy_->planned_place(*this, event, id)) {
      place = *planned;
    } else {
      places_.clear();
      const std::size_t lowest =
          strategy_->places_stores() ? graph_.lowest_readable(thread, id) + 1 : last;
      for (std::size_t p = last + 1; p-- > lowest;)
        if (graph_.free_to_place(graph_.location(id), p) &&
            (p == last || graph_.allows_place(event, id, p)))
          places_.push_back(p);
      place = places_[strategy_->choose_place(*this, event, id, places_)];
    }
  }
  graph_.finish_store(event, id, place, value);
  ++me().effects;
  note_write(event, value);
  record(event, last - place);
}

void Execution::fence(Order order, const void* pc) {
  if (phase_ != Phase::parallel) return;
  reach(0, false);
  check_limit(pc);
  Event& event = graph_.begin(EventKind::fence, cores_.current(),
                              order_at(pc, false, EventKind::fence, order), pc);
  graph_.finish_fence(event);
  record(event, 0);
}

unsigned Execution::other_choice(unsigned count, const void* pc) {
  if (phase_ != Phase::parallel) return 0;
  Event& event = graph_.begin(EventKind::choice, cores_.current(), Order::relaxed, pc);
  const unsigned option = strategy_->choose_other(*this, event, count);
  graph_.finish_choice(event, option);
  record(event, option);
  return option;
}

// --- Waiting --------------------------------------------------------------------------------

void Execution::lock(std::uintptr_t address, const void* pc) {
  if (!observed()) return Tenant::lock(address, pc);
  if (alone()) {
    if (!try_lock(address, pc))
      report(FindingKind::deadlock, "the only thread waits at {0} for a lock that nobody releases",
             {pc});
    return;
  }
  reach(address, true);
  read_event(
      {address, 4, pc, Order::acquire, Order::relaxed}, true,
      [](Value value) { return value == 0 ? Meaning::modify : Meaning::wait; },
      [](Value) { return Value{1}; });
}

bool Execution::try_lock(std::uintptr_t address, const void* pc) {
  Value expected = 0;
  return compare_exchange({address, 4, Order::acquire, pc}, Order::relaxed, false, expected, 1);
}

void Execution::unlock(std::uintptr_t address, const void* pc) {
  store({address, 4, Order::release, pc}, 0);
}

Wake Execution::wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                     const void* pc) {
  if (phase_ != Phase::parallel) {
    if (load({address, 4, Order::acquire, pc}) != expected) return Wake::value_differs;
    if (nanoseconds >= 0) return Wake::timed_out;
    report(FindingKind::deadlock, "the only thread sleeps at {0} and nobody is left to wake it",
           {pc});
  }
  const unsigned thread = cores_.current();
  const std::uintptr_t sleepers = sleepers_of(address);
  const Request request{sleepers, 16, pc, Order::acq_rel, Order::acquire};
  const auto leave = [&] {
    reach(sleepers, true);
    const Value before = read_event(
        request, true, [](Value) { return Meaning::modify; },
        [thread](Value value) { return without_sleeper(value, thread); });
    return is_sleeper(before, thread);
  };
  reach(sleepers, true);
  read_event(
      request, true, [](Value) { return Meaning::modify; },
      [thread](Value value) { return with_sleeper(value, thread); });
  reach(address, false);
  const Value seen = read_event(
      {address, 4, pc, Order::acquire, Order::acquire}, false, [](Value) { return Meaning::load; },
      [](Value v) { return v; });
  if (seen != expected) {
    leave();
    return Wake::value_differs;
  }
  const bool timed = nanoseconds >= 0;
  if ((timed || limits_.spurious_wakeups) && other_choice(2, pc) != 0) {
    leave();
    return timed ? Wake::timed_out : Wake::woken;
  }
  me().timed = timed;
  me().wait_sleeps = true;
  reach(sleepers, false);
  read_event(
      request, false,
      [thread](Value value) { return is_sleeper(value, thread) ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
  me().timed = me().wait_sleeps = false;
  return Wake::woken;
}

unsigned Execution::wake(std::uintptr_t address, unsigned count, const void* pc) {
  if (phase_ != Phase::parallel) return 0;
  const std::uintptr_t sleepers = sleepers_of(address);
  fence(Order::seq_cst, pc);
  reach(sleepers, true);
  const Value before = read_event(
      {sleepers, 16, pc, Order::acq_rel, Order::acquire}, true,
      [](Value) { return Meaning::modify; },
      [count](Value value) { return without_oldest(value, count); });
  return std::min(count, sleeper_count(before));
}

void Execution::signal() {
  reach(signal_address, true);
  read_event(
      {signal_address, 4, nullptr, Order::release, Order::relaxed}, true,
      [](Value) { return Meaning::modify; }, [](Value) { return Value{1}; });
}

void Execution::await_signal() {
  reach(signal_address, false);
  read_event(
      {signal_address, 4, nullptr, Order::acquire, Order::acquire}, false,
      [](Value value) { return value == 0 ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
}

std::int64_t Execution::now() {
  return observed() ? ++me().clock_reads * 1000 : 0;
}

}  // namespace irt::checker
