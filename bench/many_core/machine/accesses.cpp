#include "bench/many_core/machine/accesses.hpp"

#include <algorithm>

namespace irt::many_core {

using virtual_cores::Access;
using virtual_cores::Modification;
using virtual_cores::Order;
using virtual_cores::Value;

Accesses::Accesses(const Profile& profile, EventLoop& loop, const Heap& heap)
    : state_(loop.state()),
      loop_(loop),
      heap_(heap),
      spin_loops_(loop),
      far_atomics_(profile.far_atomic > 0) {}

// A line that is new to simulated time is where reality would have left it: memory that thread 0
// made before the run in the cache of its core; what a thread's allocator has just taken from the
// system, which the kernel has cleared there, in the cache of the thread's; anything else nowhere.
Line& Accesses::new_line(const Thread& me, std::uintptr_t address) {
  Line& line = state_.directory.make(address / line_bytes);
  unsigned core = me.core;
  if (heap_.owns(address)) {
    const bool fresh = heap_.is_fresh(address);
    core = state_.threads[fresh ? heap_.arena_of(address) : 0].core;
    line.last = core;
    if (fresh) {
      line.owner = core;
      line.used = true;
    }
  }
  line.home = static_cast<std::uint16_t>(state_.directory.topology().socket(core));
  return line;
}

// Asks for the line and waits until it is there.
inline void Accesses::fetch(Thread& me, Line& line, Want want, const void* pc,
                            std::uint64_t bytes) {
  ++me.changes;
  me.request = {.issued = me.clock,
                .pc = pc,
                .bytes = bytes,
                .takes = me.costs->rmw_hit,
                .thread = me.number,
                .core = me.core,
                .want = want};
  state_.directory.send(line, me.request, me.clock);
  loop_.wait();
}

// --- Reads -----------------------------------------------------------------------------------

void Accesses::read(Thread& me, std::uintptr_t address, std::uint64_t bytes, const void* pc) {
  Line& line = line_of(me, address);
  loop_.sync(me, ahead_of(me, line));
  if (line.held_by(me.core)) {
    SpinLoops::watch(me, line);
  } else {
    fetch(me, line, Want::copy, pc, bytes);
  }
  line.read |= bytes;
}

void Accesses::plain_read_late(Thread& me, std::uintptr_t address, std::size_t size,
                               const void* pc) {
  const std::uintptr_t end = address + size;
  while (address < end) {
    const std::size_t part =
        std::min<std::size_t>(end - address, line_bytes - address % line_bytes);
    ++state_.measurement.counts.accesses;
    // Nobody but this thread can have changed what it is about to store itself.
    bool stored = false;
    for (std::size_t i = 0; i < me.stores.size() && !stored; ++i)
      stored = me.stores[i].line->number == address / line_bytes;
    if (!stored) read(me, address, bytes_of(address, part), pc);
    me.clock += me.costs->plain_op;
    address += part;
  }
}

Value Accesses::load_late(Thread& me, const Access& access) {
  ++state_.measurement.counts.accesses;
  // The newest store of this thread to the same word is what it reads, done or not.
  for (std::size_t i = me.stores.size(); i-- > 0;) {
    const PostedStore& store = me.stores[i];
    if (store.size == 0 || store.address + store.size <= access.address ||
        access.address + access.size <= store.address)
      continue;
    if (store.address != access.address || store.size != access.size) {
      drain(me);
      break;
    }
    me.clock += me.costs->load_hit;
    return store.value;
  }
  spin_loops_.check(me, access);
  read(me, access.address, bytes_of(access.address, access.size), access.pc);
  const Value value = read_memory(access.address, access.size);
  me.clock += me.costs->load_hit;
  return value;
}

// --- Read-modify-writes ----------------------------------------------------------------------

// Gets the line of an operation that must be the only one there while it is done; null if nobody
// has used it yet.
Line& Accesses::own(Thread& me, Line* line, const Access& access, bool arithmetic) {
  ++state_.measurement.counts.accesses;
  drain(me);
  if (line == nullptr) line = &line_of(me, access.address);
  loop_.sync(me, ahead_of(me, *line));
  const std::uint64_t bytes = bytes_of(access.address, access.size);
  if (line->owner == me.core) {
    SpinLoops::watch(me, *line);
  } else {
    // Far atomics are for lines that cores compete for; one's own stays near.
    const bool far = arithmetic && far_atomics_ && line->used && line->last != me.core;
    fetch(me, *line, far ? Want::far : Want::ownership, access.pc, bytes);
  }
  line->written |= bytes;
  return *line;
}

Value Accesses::modify(Thread& me, const Access& access, Modification operation, Value operand) {
  Line* line = find(access.address);
  if (!at_hand(me, line, access.address, access.size, true)) line = &own(me, line, access, true);
  const Value before = read_memory(access.address, access.size);
  const Value after = result_of(operation, before, operand, access.size);
  write_memory(access.address, access.size, after);
  finish_update(me, *line, before != after);
  return before;
}

bool Accesses::compare_exchange(Thread& me, const Access& access, Value& expected, Value desired) {
  Line* line = find(access.address);
  if (!at_hand(me, line, access.address, access.size, true)) line = &own(me, line, access, false);
  const Value before = read_memory(access.address, access.size);
  const bool equal = before == expected;
  if (equal) write_memory(access.address, access.size, desired);
  Counts& counts = state_.measurement.counts;
  ++(equal ? counts.swaps : counts.failed_swaps);
  finish_update(me, *line, equal && before != desired);
  expected = before;
  return equal;
}

void Accesses::fence(Thread& me) {
  drain(me);
  me.clock += me.costs->rmw_hit;
}

void Accesses::take(Thread& me, std::uintptr_t address, bool arithmetic, const void* pc) {
  Line& line = own(me, find(address), {address, 4, Order::acquire, pc}, arithmetic);
  finish_update(me, line, true);
}

// --- Stores ----------------------------------------------------------------------------------

void Accesses::store(Thread& me, const Access& access, Value value) {
  if (access.order == Order::seq_cst) {  // an exchange, on x86
    Line& line = own(me, find(access.address), access, true);
    const bool changed = read_memory(access.address, access.size) != value;
    write_memory(access.address, access.size, value);
    finish_update(me, line, changed);
    return;
  }
  ++state_.measurement.counts.accesses;
  Line& line = line_of(me, access.address);
  loop_.sync(me, ahead_of(me, line));
  const std::uint64_t bytes = bytes_of(access.address, access.size);
  if (line.owner == me.core && me.stores.empty()) {
    SpinLoops::watch(me, line);
    me.changes += read_memory(access.address, access.size) != value ? 1 : 0;
    write_memory(access.address, access.size, value);
    line.written |= bytes;
    line.available = std::max(line.available, me.clock);
  } else {
    ++me.changes;
    post(me, {.line = &line,
              .pc = access.pc,
              .bytes = bytes,
              .address = access.address,
              .size = access.size,
              .value = value});
  }
  me.clock += me.costs->store_hit;
}

void Accesses::plain_write_late(Thread& me, std::uintptr_t address, std::size_t size,
                                const void* pc) {
  ++me.changes;
  const std::uintptr_t end = address + size;
  while (address < end) {
    const std::size_t part =
        std::min<std::size_t>(end - address, line_bytes - address % line_bytes);
    ++state_.measurement.counts.accesses;
    Line& line = line_of(me, address);
    loop_.sync(me, ahead_of(me, line));
    const std::uint64_t bytes = bytes_of(address, part);
    if (line.owner == me.core) {
      line.written |= bytes;
    } else if (me.stores.empty() || me.stores[me.stores.size() - 1].line != &line) {
      post(me, {.line = &line, .pc = pc, .bytes = bytes});
    }
    me.clock += me.costs->plain_op;
    address += part;
  }
}

// Waits for a place in the store buffer, if it must.
void Accesses::post(Thread& me, const PostedStore& store) {
  if (me.stores.full()) {
    const Time since = me.clock;
    me.crowded = true;
    loop_.wait();
    me.crowded = false;
    state_.measurement.note_wait(Cause::stores, since, me.clock);
  }
  loop_.stores().post(me, store);
}

void Accesses::wait_for_stores(Thread& me) {
  const Time since = me.clock;
  if (!me.stores.empty()) {
    me.draining = true;
    loop_.wait();
  }
  me.clock = std::max(me.clock, me.committed);
  state_.measurement.note_wait(Cause::stores, since, me.clock);
}

}  // namespace irt::many_core
