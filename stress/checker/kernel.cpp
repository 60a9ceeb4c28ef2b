#include "stress/checker/kernel.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "queues/split_mix.hpp"

namespace irt::checker {

using virtual_cores::Wake;
using Meaning = Accesses::Meaning;
using Request = Accesses::Request;

namespace {

// Where a futex keeps its sleepers: sixteen bytes, which must not overlap with those of the next.
std::uintptr_t sleepers_of(std::uintptr_t address) {
  return address << 4U | made_up;
}

// Below are the other objects that no program has; no futex is at so low an address.
constexpr std::uintptr_t lowest_sleepers = made_up | 0x10000U;

// What S and W of a shape write and read.
constexpr std::uintptr_t signal_address = made_up | 64U;
// Where meet() counts.
constexpr std::uintptr_t barrier_address = made_up | 192U;
// The clock of tick().
constexpr std::uintptr_t clock_address = made_up | 128U;

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
Value without_sleeper(Value sleepers, unsigned thread) {
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

std::string Kernel::what_is(std::uintptr_t address, const Event& event) {
  if (address < lowest_sleepers) return "";
  const bool before = is_sleeper(event.read, event.thread);
  if (!event.writes) return before ? "sleeps" : "wakes up";
  if (is_sleeper(event.written, event.thread)) return "goes to sleep";
  if (before) return "does not sleep";
  std::string woken;
  for (Value sleepers = event.read; sleepers != 0; sleepers >>= 8) {
    const auto thread = static_cast<unsigned>(sleepers & 0xFF) - 1;
    if (!is_sleeper(event.written, thread)) woken += fmt::format(" thread {},", thread);
  }
  return woken.empty() ? "wakes nobody" : "wakes" + woken.substr(0, woken.size() - 1);
}

bool Kernel::times_out(std::int64_t nanoseconds, const void* pc) {
  if (!loops_.times_out(pc)) return false;
  pass(nanoseconds);
  return true;
}

bool Kernel::lock(std::uintptr_t address, std::int64_t nanoseconds, const void* pc) {
  const bool timed = nanoseconds >= 0;
  const bool alone = state_.phase != Phase::parallel;
  if (timed || alone) {
    if (try_lock(address, pc)) return true;
    if (timed && (state_.phase != Phase::parallel || times_out(nanoseconds, pc))) return false;
  }
  if (state_.phase != Phase::parallel) {
    if (state_.phase == Phase::endless) alone_.conclude(true, pc);
    state_.conclusion.report(FindingKind::deadlock,
                             "the only thread waits at {0} for a lock that nobody releases", {pc});
  }
  turns_.mine().timed = timed;
  accesses_.read(
      {address, 4, pc, Order::acquire, Order::relaxed},
      [](Value value) { return value == 0 ? Meaning::modify : Meaning::wait; },
      [](Value) { return Value{1}; });
  turns_.mine().timed = false;
  return true;
}

bool Kernel::try_lock(std::uintptr_t address, const void* pc) {
  Value expected = 0;
  return accesses_.compare_exchange({address, 4, Order::acquire, pc}, Order::relaxed, false,
                                    expected, 1);
}

void Kernel::unlock(std::uintptr_t address, const void* pc) {
  accesses_.store({address, 4, Order::release, pc}, 0);
}

Wake Kernel::wait_alone(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                        const void* pc) {
  if (accesses_.load({address, 4, Order::acquire, pc}) != expected) return Wake::value_differs;
  if (nanoseconds >= 0) {
    pass(nanoseconds);
    return Wake::timed_out;
  }
  if (state_.phase == Phase::endless) alone_.conclude(true, pc);
  state_.conclusion.report(FindingKind::deadlock,
                           "the only thread sleeps at {0} and nobody is left to wake it", {pc});
}

Wake Kernel::wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                  const void* pc) {
  const bool timed = nanoseconds >= 0;
  if (state_.phase != Phase::parallel) return wait_alone(address, expected, nanoseconds, pc);
  const auto look = [&] {
    return accesses_.look({address, 4, pc, Order::acquire, Order::acquire, false});
  };
  if (timed && times_out(nanoseconds, pc)) {  // who is not woken in time leaves nothing behind
    accesses_.fence(Order::seq_cst, pc);
    return look() == expected ? Wake::timed_out : Wake::value_differs;
  }
  const unsigned thread = state_.current();
  Request request{sleepers_of(address), 16, pc, Order::acq_rel, Order::acquire};
  // False if a wake-up has already taken it out.
  const auto leave = [&] {
    const Value before =
        accesses_.change(request, [thread](Value value) { return without_sleeper(value, thread); });
    return is_sleeper(before, thread);
  };
  turns_.keep(true);
  accesses_.change(request, [thread](Value value) { return with_sleeper(value, thread); });
  accesses_.fence(Order::seq_cst, pc);  // as the kernel, and as wake() on the other side
  const bool differs = look() != expected;
  turns_.keep(false);
  if (differs) {
    // A kernel looks and puts it to sleep in one step, in which nobody can wake it.
    if (!leave()) turns_.dismiss(pc);
    return Wake::value_differs;
  }
  if (state_.limits.spurious_wakeups && loops_.chosen_once(pc)) {
    leave();
    return Wake::woken;
  }
  turns_.mine().timed = timed;
  turns_.mine().sleeps = true;
  request.writes = false;
  accesses_.read(
      request,
      [thread](Value value) { return is_sleeper(value, thread) ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
  turns_.mine().timed = turns_.mine().sleeps = false;
  return Wake::woken;
}

unsigned Kernel::wake(std::uintptr_t address, unsigned count, const void* pc) {
  if (state_.phase != Phase::parallel) return 0;
  accesses_.fence(Order::seq_cst, pc);
  const Value before =
      accesses_.change({sleepers_of(address), 16, pc, Order::acq_rel, Order::acquire},
                       [count](Value value) { return without_oldest(value, count); });
  return std::min(count, sleeper_count(before));
}

void Kernel::signal() {
  accesses_.change({signal_address, 4, nullptr, Order::release, Order::relaxed},
                   [](Value) { return Value{1}; });
}

void Kernel::await_signal() {
  accesses_.read(
      {signal_address, 4, nullptr, Order::acquire, Order::acquire, false},
      [](Value value) { return value == 0 ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
}

void Kernel::meet(unsigned threads) {
  const Value before =
      accesses_.change({barrier_address, 8, nullptr, Order::acq_rel, Order::relaxed},
                       [](Value value) { return value + 1; });
  const Value all = (before / threads + 1) * threads;
  if (before + 1 == all) return;
  accesses_.read(
      {barrier_address, 8, nullptr, Order::acquire, Order::acquire, false},
      [all](Value value) { return value < all ? Meaning::wait : Meaning::load; },
      [](Value value) { return value; });
}

// seq_cst, so that what the model takes for time agrees with the order of all that is seq_cst.
std::uint64_t Kernel::tick() {
  if (state_.phase != Phase::parallel) return 0;
  const Value before = accesses_.change({.address = clock_address,
                                         .size = 8,
                                         .pc = nullptr,
                                         .success = Order::seq_cst,
                                         .failure = Order::seq_cst,
                                         .silent = true},
                                        [](Value value) { return value + 1; });
  return static_cast<std::uint64_t>(before) + 1;
}

// Code may look there for as long as it likes, and nothing else would ask for the time.
void Kernel::look_outside() {
  alone_.pass_unwatched();
  if (state_.observed()) state_.conclusion.check_time();
}

std::int64_t Kernel::time() const {
  const unsigned thread = state_.current();
  const Clock& known = state_.graph.thread(thread).now;
  std::int64_t time = 0;
  for (unsigned other = 0; other < asked_.size(); ++other) {
    const std::vector<Reading>& clock = asked_[other].clock;
    // What another one reads is known from its next event on.
    const auto after =
        other == thread ? clock.end()
                        : std::ranges::lower_bound(clock, known.count[other], {}, &Reading::moment);
    if (after != clock.begin()) time = std::max(time, std::prev(after)->time);
  }
  return time;
}

void Kernel::pass(std::int64_t nanoseconds) {
  if (state_.phase == Phase::idle || nanoseconds <= 0) return;
  const unsigned thread = state_.current();
  const Reading reading{state_.graph.thread(thread).now.count[thread], time() + nanoseconds};
  std::vector<Reading>& clock = asked_[thread].clock;
  if (!clock.empty() && clock.back().moment == reading.moment)
    clock.back() = reading;
  else
    clock.push_back(reading);
}

std::int64_t Kernel::now() {
  constexpr std::int64_t one_look = 1000;
  look_outside();
  pass(one_look);
  return state_.phase == Phase::idle ? 0 : time();
}

std::uint64_t Kernel::random() {
  // For each thread from another place on, and the same in every execution.
  look_outside();
  const std::uint64_t thread = state_.current();
  return SplitMix::at((thread << 32U) + ++asked_[thread].random);
}

}  // namespace irt::checker
