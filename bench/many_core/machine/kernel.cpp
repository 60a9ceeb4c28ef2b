// What the kernel and the C library do: locks, sleeping and waking, the scheduler, the allocator.

#include <algorithm>

#include "bench/many_core/machine/machine.hpp"

namespace irt::many_core {

using virtual_cores::Access;
using virtual_cores::Operation;
using virtual_cores::Order;
using virtual_cores::Value;
using virtual_cores::Wake;

namespace {

// Where the kernel keeps the list of sleepers of a word: a line for each, in a place of its own.
constexpr std::uintptr_t buckets_address = 0x180000000000;

// What a call of the C library executes besides its atomic operations, in plain accesses: counted
// in glibc 2.36, pthread_mutex_lock and malloc from the tcache.
constexpr Time lock_accesses = 8;
constexpr Time heap_accesses = 10;

}  // namespace

// --- Locks, as glibc 2.36 has them (lowlevellock.c) ---------------------------------------------

bool Machine::try_lock(std::uintptr_t address, const void* pc) {
  if (timed_) me_->clock += lock_accesses * me_->costs->plain_op;
  Value expected = 0;
  return compare_exchange({address, 4, Order::acquire, pc}, Order::relaxed, false, expected, 1);
}

void Machine::lock(std::uintptr_t address, const void* pc) {
  if (try_lock(address, pc)) return;
  const Access access{address, 4, Order::acquire, pc};
  if (load(access) == 2) wait(address, 2, -1, pc);
  while (modify(access, Operation::exchange, 2) != 0) wait(address, 2, -1, pc);
}

void Machine::unlock(std::uintptr_t address, const void* pc) {
  if (timed_) me_->clock += lock_accesses * me_->costs->plain_op;
  if (modify({address, 4, Order::release, pc}, Operation::exchange, 0) == 2) wake(address, 1, pc);
}

// --- Futexes ------------------------------------------------------------------------------------

Machine::Sleepers& Machine::sleepers_of(std::uintptr_t address) {
  const auto [found, fresh] = sleepers_.try_emplace(address);
  if (fresh) found->second.bucket = buckets_address + line_bytes * sleepers_.size();
  return found->second;
}

// Takes the lock of a bucket, which is held too shortly to be waited for in sleep.
void Machine::enter_bucket(Thread& me, std::uintptr_t bucket, const void* pc) {
  Line& line = own(me, {bucket, 4, Order::acquire, pc}, true);
  finish_update(me, line, true);
}

Wake Machine::wait(std::uintptr_t address, std::uint32_t expected, std::int64_t nanoseconds,
                   const void* pc) {
  if (!timed_) return Tenant::wait(address, expected, nanoseconds, pc);
  Thread& me = *me_;
  me.clock += syscall_;
  Sleepers& sleepers = sleepers_of(address);
  enter_bucket(me, sleepers.bucket, pc);
  // The kernel looks at the word while it holds the bucket.
  read_line(me, address, std::uint64_t{0xF} << address % line_bytes, pc);
  if (virtual_cores::read_memory(address, 4) != expected) return Wake::value_differs;
  sleepers.threads.push_back(me.number);
  me.sleeps_at = address;
  ++counts_.sleeps;
  me.clock += futex_wait_;
  park(me, nanoseconds < 0 ? never : me.clock + nanoseconds * nanosecond);
  return me.timed_out ? Wake::timed_out : Wake::woken;
}

unsigned Machine::wake(std::uintptr_t address, unsigned count, const void* pc) {
  if (!timed_) return 0;
  Thread& me = *me_;
  drain(me);
  me.clock += syscall_;
  Sleepers& sleepers = sleepers_of(address);
  read_line(me, sleepers.bucket, 0xF, pc);
  if (sleepers.threads.empty()) return 0;
  enter_bucket(me, sleepers.bucket, pc);
  unsigned woken = 0;
  while (woken < count && !sleepers.threads.empty()) {
    Thread& thread = threads_[sleepers.threads.front()];
    sleepers.threads.pop_front();
    me.clock += wake_call_;
    unpark(thread, me.clock);
    ++woken;
  }
  return woken;
}

// --- The scheduler: round robin among the threads of a hardware thread ---------------------------

// Sleeps until somebody wakes the thread, or until a moment.
void Machine::park(Thread& me, Time until) {
  drain(me);
  me.parked = true;
  me.woken = me.timed_out = false;
  if (until != never) events_.push(me.event, until);
  set_busy(me.core, nobody);
  run_next(hardware_[me.core], me.clock);
  go_on();
  me.parked = false;
  ++me.changes;
}

void Machine::unpark(Thread& thread, Time at) {
  if (thread.event.scheduled) events_.remove(thread.event);
  thread.woken = true;
  Hardware& hardware = hardware_[thread.core];
  const bool idle = hardware.running == nobody;
  const Time ready = std::max(at, thread.clock) + (idle ? wake_latency_ : 0);
  note_wait(Cause::parked, thread.clock, ready);
  thread.clock = ready;
  if (idle) {
    set_busy(thread.core, thread.number);
    hardware.quantum_end = ready + quantum_;
    events_.push(thread.event, ready);
  } else {
    hardware.ready.push_back(thread.number);
  }
  set_deadline(thread.core);
}

// The time that a parked thread wanted to sleep at most has passed.
void Machine::time_out(Thread& thread, Time at) {
  std::deque<unsigned>& threads = sleepers_[thread.sleeps_at].threads;
  threads.erase(std::remove(threads.begin(), threads.end(), thread.number), threads.end());
  thread.timed_out = true;
  unpark(thread, at);
}

// The hardware thread is free at `at`: the next of those that are ready has it.
void Machine::run_next(Hardware& hardware, Time at) {
  if (hardware.ready.empty()) return;
  Thread& next = threads_[hardware.ready.front()];
  hardware.ready.pop_front();
  set_busy(next.core, next.number);
  const Time begin = std::max(at + switch_, next.clock);
  note_wait(Cause::scheduler, next.clock, begin);
  hardware.quantum_end = begin + quantum_;
  set_deadline(next.core);
  events_.push(next.event, begin);
}

// Lets the others on this hardware thread run, if there are any and its quantum is used up.
void Machine::give_way(Thread& me) {
  Hardware& hardware = hardware_[me.core];
  if (hardware.ready.empty()) return;
  hardware.ready.push_back(me.number);
  run_next(hardware, me.clock);
  go_on();
}

void Machine::set_deadline(unsigned place) {
  const Hardware& hardware = hardware_[place];
  if (hardware.running == nobody) return;
  Thread& thread = threads_[hardware.running];
  thread.deadline = hardware.ready.empty() ? limit_ : std::min(limit_, hardware.quantum_end);
  // A thread that sleeps in a loop looks up, too.
  if (thread.loop.period != 0 && thread.event.scheduled && thread.deadline < thread.event.time)
    events_.move(thread.event, std::max(thread.deadline, thread.clock));
}

// Notes who runs on a hardware thread; siblings are slower beside each other.
void Machine::set_busy(unsigned place, unsigned thread) {
  hardware_[place].running = thread;
  const unsigned first = place / profile_.smt * profile_.smt;
  unsigned busy = 0;
  for (unsigned i = first; i < first + profile_.smt; ++i)
    busy += hardware_[i].running != nobody ? 1 : 0;
  for (unsigned i = first; i < first + profile_.smt; ++i)
    if (hardware_[i].running != nobody)
      threads_[hardware_[i].running].costs = busy > 1 ? &beside_sibling_ : &alone_;
}

void Machine::yield(const void* /*pc*/) {
  if (!timed_) return;
  Thread& me = *me_;
  me.clock += syscall_;
  sync(me);
  give_way(me);
}

void Machine::sleep(std::int64_t nanoseconds, const void* /*pc*/) {
  if (!timed_) return;
  Thread& me = *me_;
  me.clock += syscall_;
  me.sleeps_at = 0;
  park(me, me.clock + std::max<std::int64_t>(nanoseconds, 0) * nanosecond);
}

void Machine::pause() {
  if (timed_) me_->clock += me_->costs->pause;
}

// --- The allocator ------------------------------------------------------------------------------

void Machine::allocator_traffic(Thread& me, const Heap::Traffic& traffic, const void* pc) {
  me.clock += heap_accesses * me.costs->plain_op;
  ++me.changes;
  if (traffic.locked == 0) return;
  Line& line = own(me, {traffic.locked, 4, Order::acquire, pc}, false);
  finish_update(me, line, true);
  if (traffic.linked != 0) plain_read(traffic.linked, 8, pc);
  me.clock += me.costs->rmw_hit;  // the lock is released
}

void* Machine::allocate(std::size_t size, std::size_t alignment, const void* pc) {
  const unsigned thread =
      virtual_cores::current_core == virtual_cores::host ? 0 : virtual_cores::current_core;
  Heap::Traffic traffic;
  void* block = heap_.allocate(thread, size, alignment, pc, traffic);
  if (timed_) allocator_traffic(threads_[thread], traffic, pc);
  return block;
}

void Machine::release(void* block, const void* pc) {
  const unsigned thread =
      virtual_cores::current_core == virtual_cores::host ? 0 : virtual_cores::current_core;
  // A library that nobody sees may have allocated it.
  if (!heap_.owns(reinterpret_cast<std::uintptr_t>(block))) {
    Tenant::release(block, pc);
    return;
  }
  Heap::Traffic traffic;
  heap_.release(thread, block, traffic);
  if (timed_) allocator_traffic(threads_[thread], traffic, pc);
}

std::size_t Machine::block_size(void* block) {
  return heap_.owns(reinterpret_cast<std::uintptr_t>(block)) ? heap_.size_of(block)
                                                             : Tenant::block_size(block);
}

}  // namespace irt::many_core
