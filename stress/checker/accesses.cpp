// What the code does to atomic objects, locks and futexes, put into the graph.

#include <algorithm>

#include "queues/split_mix.hpp"
#include "stress/checker/execution.hpp"

namespace irt::checker {

using virtual_cores::Access;
using virtual_cores::Wake;

namespace {

// Where a futex keeps its sleepers: an address that no program has.
std::uintptr_t sleepers_of(std::uintptr_t address) {
  return address | (std::uintptr_t{1} << 63U);
}

// What S and W of a shape write and read.
constexpr std::uintptr_t signal_address = (std::uintptr_t{1} << 63U) | 64U;
// Where meet() counts.
constexpr std::uintptr_t barrier_address = (std::uintptr_t{1} << 63U) | 192U;
// The clock of tick().
constexpr std::uintptr_t clock_address = (std::uintptr_t{1} << 63U) | 128U;

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

void Execution::record(const Event& event, std::size_t choice) {
  if (phase_ != Phase::parallel) return;
  walk_ = 0;
  ++beats_;
  check_time();
  steps_.push_back(
      {event.thread, static_cast<std::uint8_t>(event.kind), static_cast<std::uint16_t>(choice)});
  strategy_->added(*this, event);
}

void Execution::note_write(const Event& event, Value before) {
  ++stores_;
  const Location& location = graph_.location(event.location);
  if (event.written != before) ++me().effects;
  if (location.stores.back() == graph_.id_of(event) && location.address >> 63U == 0)
    virtual_cores::write_memory(location.address, location.size, event.written);
}

// The thread has begun to run alone: memory holds every value.
template <class Decide, class NewValue>
Value Execution::read_alone(const Request& request, Decide decide, NewValue new_value) {
  if (request.address >> 63U != 0) give_up("a thread that makes too many steps waits or wakes");
  const Value value = virtual_cores::read_memory(request.address, request.size);
  const Meaning meaning = decide(value);
  if (meaning == Meaning::wait) conclude_alone(true, request.pc);
  if (meaning == Meaning::modify) {
    alone_.note_write(request.address, request.size);
    virtual_cores::write_memory(request.address, request.size, new_value(value));
  }
  return value;
}

template <class Decide, class NewValue>
Value Execution::read_event(const Request& request, bool may_write, Decide decide,
                            NewValue new_value) {
  const unsigned thread = cores_.current();
  const bool real = request.address >> 63U == 0;
  for (;;) {
    check_limit(request.pc);
    if (phase_ == Phase::endless) return read_alone(request, decide, new_value);
    check_news(request.pc);
    if (real) check_touch(request.address, request.size, may_write, true, request.pc);
    const Part part = part_at(request.address, request.size);
    const std::uint32_t id = part.location;
    const auto value_at = [&](std::size_t place) {
      return graph_.event(graph_.location(id).stores[place]).written >> part.shift & part.mask;
    };
    const std::size_t newest = graph_.location(id).stores.size() - 1;
    Event& event = graph_.begin(EventKind::load, thread, request.success, request.pc);
    event.silent = request.silent;
    const auto prepare = [&](Meaning meaning) {
      event.kind = meaning == Meaning::modify ? EventKind::modify : EventKind::load;
      event.order = meaning == Meaning::modify ? request.success
                    : meaning == Meaning::load ? request.failure
                                               : Order::relaxed;
      event.blocked = meaning == Meaning::wait;
      event.failed = request.compares && meaning == Meaning::load;
    };
    std::size_t place = newest;
    const auto before = std::find_if(me().visits.begin(), me().visits.end(),
                                     [&](const Visit& v) { return v.pc == request.pc; });
    if (phase_ == Phase::parallel) {
      std::optional<std::size_t> same;  // where what the loop insists on is
      if (me().insists != nullptr && before != me().visits.end() &&
          before->read >= me().round_began)
        same = graph_.find_place(id, before->store);
      const auto may_read_again = [&] {
        prepare(Meaning::load);
        return decide(value_at(*same)) == Meaning::load &&
               *same >= graph_.lowest_readable(thread, id) &&
               graph_.allows_read(event, id, *same, false);
      };
      if (const auto planned = strategy_->planned_place(*this, event, id)) {
        place = *planned;
        event.settled = same == place && decide(value_at(place)) == Meaning::load;
      } else if (same && may_read_again()) {
        place = *same;
        event.settled = true;
      } else {
        options_.clear();
        const bool fresh = me().fresh_reads != 0;
        if (fresh) --me().fresh_reads;
        std::size_t lowest = fresh ? newest : graph_.lowest_readable(thread, id);
        if (before != me().visits.end() && before->count >= limits_.same_reads)
          if (const auto old = graph_.find_place(id, before->from); old && !is_newest(before->from))
            lowest = std::max(lowest, *old + 1);
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
    if (!event.settled) me().insists = nullptr;
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

// Outside of the threads' time everything happens before or after everything else, so that a read
// finds what memory holds and nothing needs an event.
void Execution::step_alone(std::uintptr_t address, std::size_t size, bool writes, const void* pc) {
  if (!observed()) return note_unwatched();
  if (address >> 63U == 0) note(writes ? Look::Kind::write : Look::Kind::read, address, size);
  check_touch(address, size, writes, true, pc);
  if (phase_ != Phase::endless && walk_ <= long_walk) return;
  if (writes && address >> 63U == 0) alone_.note_write(address, size);
  look_alone(pc);
}

Value Execution::load(const Access& access) {
  if (phase_ != Phase::parallel) {
    step_alone(access.address, access.size, false, access.pc);
    return Tenant::load(access);
  }
  check_loop(access.pc);
  reach(access.address, false);
  const Order order = orders_.at(access.pc, false, EventKind::load, access.order);
  return read_event(
      {access.address, access.size, access.pc, order, order}, false,
      [](Value) { return Meaning::load; }, [](Value value) { return value; });
}

Value Execution::modify(const Access& access, virtual_cores::Modification operation,
                        Value operand) {
  if (phase_ != Phase::parallel) {
    step_alone(access.address, access.size, true, access.pc);
    return Tenant::modify(access, operation, operand);
  }
  check_loop(access.pc);
  reach(access.address, true);
  const Order order = orders_.at(access.pc, false, EventKind::modify, access.order);
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
       orders_.at(access.pc, false, EventKind::modify, access.order),
       orders_.at(access.pc, true, EventKind::modify, failure), false, true},
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
  if (phase_ == Phase::endless) {
    alone_.note_write(access.address, access.size);
    return Tenant::store(access, value);
  }
  const Part part = part_at(access.address, access.size);
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
                   orders_.at(access.pc, false, EventKind::store, access.order), access.pc);
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
  if (phase_ != Phase::parallel) return;
  Event& event = graph_.begin(EventKind::fence, cores_.current(),
                              orders_.at(pc, false, EventKind::fence, order), pc);
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

// Whether the unusual happens, where it may.
bool Execution::chosen(const void* pc) {
  if (phase_ != Phase::parallel) return false;
  reach(0, false);
  check_limit(pc);
  return other_choice(2, pc) != 0;
}

// --- Waiting --------------------------------------------------------------------------------

// Who insists on what a loop reads until it gives up sees no wait of it end.
bool Execution::times_out(std::int64_t nanoseconds, const void* pc) {
  if (me().insists == nullptr && !chosen(pc)) return false;
  me().waited += nanoseconds;
  return true;
}

bool Execution::lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) {
  if (!observed()) return Tenant::lock(address, nanoseconds, pc);
  const bool timed = nanoseconds >= 0;
  if (timed || alone()) {
    if (try_lock(address, pc)) return true;
    if (timed && (alone() || times_out(nanoseconds, pc))) return false;
  }
  if (alone()) {
    if (phase_ == Phase::endless) conclude_alone(true, pc);
    report(FindingKind::deadlock, "the only thread waits at {0} for a lock that nobody releases",
           {pc});
  }
  me().timed = timed;
  reach(address, true);
  read_event(
      {address, 4, pc, Order::acquire, Order::relaxed}, true,
      [](Value value) { return value == 0 ? Meaning::modify : Meaning::wait; },
      [](Value) { return Value{1}; });
  me().timed = false;
  return true;
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
    if (nanoseconds >= 0) {
      if (phase_ != Phase::idle) me().waited += nanoseconds;
      return Wake::timed_out;
    }
    if (phase_ == Phase::endless) conclude_alone(true, pc);
    report(FindingKind::deadlock, "the only thread sleeps at {0} and nobody is left to wake it",
           {pc});
  }
  const bool timed = nanoseconds >= 0;
  const auto look = [&] {
    reach(address, false);
    return read_event(
        {address, 4, pc, Order::acquire, Order::acquire}, false,
        [](Value) { return Meaning::load; }, [](Value v) { return v; });
  };
  if (timed && times_out(nanoseconds, pc)) {  // who is not woken in time leaves nothing behind
    fence(Order::seq_cst, pc);
    return look() == expected ? Wake::timed_out : Wake::value_differs;
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
  fence(Order::seq_cst, pc);  // as the kernel, and as wake() on the other side
  if (look() != expected) {
    leave();
    return Wake::value_differs;
  }
  if (limits_.spurious_wakeups && other_choice(2, pc) != 0) {
    leave();
    return Wake::woken;
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

void Execution::meet(unsigned threads) {
  reach(barrier_address, true);
  const Value before = read_event(
      {barrier_address, 8, nullptr, Order::acq_rel, Order::relaxed}, true,
      [](Value) { return Meaning::modify; }, [](Value value) { return value + 1; });
  const Value all = (before / threads + 1) * threads;
  if (before + 1 == all) return;
  reach(barrier_address, false);
  read_event(
      {barrier_address, 8, nullptr, Order::acquire, Order::acquire}, false,
      [all](Value value) { return value < all ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
}

// seq_cst, so that what the model takes for time agrees with the order of all that is seq_cst.
std::uint64_t Execution::tick() {
  if (phase_ != Phase::parallel) return 0;
  reach(clock_address, true);
  const Value before = read_event(
      {clock_address, 8, nullptr, Order::seq_cst, Order::seq_cst, true}, true,
      [](Value) { return Meaning::modify; }, [](Value value) { return value + 1; });
  return static_cast<std::uint64_t>(before) + 1;
}

// Code may look there for as long as it likes, and nothing else would ask for the time.
void Execution::note_look_outside() {
  note_unwatched();
  if (observed()) check_time();
}

std::int64_t Execution::now() {
  note_look_outside();
  if (phase_ == Phase::idle) return 0;
  ++me().clock_reads;
  return time();
}

std::uint64_t Execution::random() {
  // For each thread from another place on, and the same in every execution.
  note_look_outside();
  return SplitMix::at((std::uint64_t{cores_.current()} << 32U) + ++me().draws);
}

}  // namespace irt::checker
