// What an access to memory does in simulated time.

#include <algorithm>

#include "bench/many_core/machine/machine.hpp"

namespace irt::many_core {

using virtual_cores::Access;
using virtual_cores::Operation;
using virtual_cores::Order;
using virtual_cores::Value;

namespace {

std::uint64_t read_word(std::uintptr_t address) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  return *reinterpret_cast<const volatile std::uint64_t*>(address);
}
void write_word(std::uintptr_t address, std::uint64_t value) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  *reinterpret_cast<volatile std::uint64_t*>(address) = value;
}
// As virtual_cores::read_memory and write_memory; inline, for nearly all words have eight bytes.
Value read_memory(std::uintptr_t address, std::size_t size) {
  return size == 8 ? read_word(address) : virtual_cores::read_memory(address, size);
}
void write_memory(std::uintptr_t address, std::size_t size, Value value) {
  if (size == 8) {
    write_word(address, static_cast<std::uint64_t>(value));
  } else {
    virtual_cores::write_memory(address, size, value);
  }
}
// As virtual_cores::apply, on half as many bits for nearly all words.
Value result_of(Operation operation, Value before, Value operand, std::size_t size) {
  return size == 8 ? virtual_cores::apply(operation, static_cast<std::uint64_t>(before),
                                          static_cast<std::uint64_t>(operand), size)
                   : virtual_cores::apply(operation, before, operand, size);
}

}  // namespace

// A line that is new to simulated time is where reality would have left it: memory that thread 0
// made before the run in the cache of its core; what a thread's allocator has just taken from the
// system, which the kernel has cleared there, in the cache of the thread's; anything else nowhere.
Line& Machine::new_line(const Thread& me, std::uintptr_t address) {
  Line& line = directory_.make(address / line_bytes);
  unsigned core = me.core;
  if (heap_.owns(address)) {
    const bool fresh = heap_.is_fresh(address);
    core = threads_[fresh ? heap_.arena_of(address) : 0].core;
    line.last = core;
    if (fresh) {
      line.owner = core;
      line.used = true;
    }
  }
  line.home = static_cast<std::uint16_t>(directory_.topology().socket(core));
  return line;
}

// Asks for the line and waits until it is there.
inline void Machine::fetch(Thread& me, Line& line, Want want, const void* pc, std::uint64_t bytes) {
  ++me.changes;
  me.request = {.issued = me.clock,
                .pc = pc,
                .bytes = bytes,
                .takes = me.costs->rmw_hit,
                .thread = me.number,
                .core = me.core,
                .want = want};
  directory_.send(line, me.request, me.clock);
  go_on();
}

// --- Reads -----------------------------------------------------------------------------------

void Machine::read_line(Thread& me, std::uintptr_t address, std::uint64_t bytes, const void* pc) {
  Line& line = line_of(me, address);
  sync(me, ahead_of(me, line));
  if (line.held_by(me.core)) {
    watch(me, line);
  } else {
    fetch(me, line, Want::copy, pc, bytes);
  }
  line.read |= bytes;
}

void Machine::plain_read(std::uintptr_t address, std::size_t size, const void* pc) {
  if (!timed_) return;
  Thread& me = *me_;
  if (address - me.stack < me.stack_bytes) {
    me.clock += me.costs->plain_op;
    return;
  }
  Line* line = at_hand(me, address, size, false);
  if (line == nullptr) {
    plain_read_late(me, address, size, pc);
    return;
  }
  me.clock += me.costs->plain_op;
}

void Machine::plain_read_late(Thread& me, std::uintptr_t address, std::size_t size,
                              const void* pc) {
  const std::uintptr_t end = address + size;
  while (address < end) {
    const std::size_t part =
        std::min<std::size_t>(end - address, line_bytes - address % line_bytes);
    ++counts_.accesses;
    // Nobody but this thread can have changed what it is about to store itself.
    bool stored = false;
    for (std::size_t i = 0; i < me.stores.size() && !stored; ++i)
      stored = me.stores[i].line->number == address / line_bytes;
    if (!stored) read_line(me, address, bytes_of(address, part), pc);
    me.clock += me.costs->plain_op;
    address += part;
  }
}

Value Machine::load(const Access& access) {
  Thread& me = *me_;
  LoopState& loop = me.loop;
  Line* line = nullptr;
  if (loop.age + 1 < LoopState::longest && (access.pc != loop.pc || access.address != loop.address))
    line = at_hand(me, access.address, access.size, false);
  if (line == nullptr) return load_late(access);
  ++loop.age;
  me.clock += me.costs->load_hit;
  return read_memory(access.address, access.size);
}

Value Machine::load_late(const Access& access) {
  if (!timed_) return Tenant::load(access);
  Thread& me = *me_;
  ++counts_.accesses;
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
  check_loop(me, access);
  read_line(me, access.address, bytes_of(access.address, access.size), access.pc);
  const Value value = read_memory(access.address, access.size);
  me.clock += me.costs->load_hit;
  return value;
}

// --- Read-modify-writes ----------------------------------------------------------------------

// Gets the line of an operation that must be the only one there while it is done.
Line& Machine::own(Thread& me, const Access& access, bool arithmetic) {
  ++counts_.accesses;
  drain(me);
  Line& line = line_of(me, access.address);
  sync(me, ahead_of(me, line));
  const std::uint64_t bytes = bytes_of(access.address, access.size);
  if (line.owner == me.core) {
    watch(me, line);
  } else {
    // Far atomics are for lines that cores compete for; one's own stays near.
    const bool far = arithmetic && profile_.far_atomic > 0 && line.used && line.last != me.core;
    fetch(me, line, far ? Want::far : Want::ownership, access.pc, bytes);
  }
  line.written |= bytes;
  return line;
}

Value Machine::modify(const Access& access, Operation operation, Value operand) {
  if (!timed_) return Tenant::modify(access, operation, operand);
  Thread& me = *me_;
  Line* line = at_hand(me, access.address, access.size, true);
  if (line == nullptr) line = &own(me, access, true);
  const Value before = read_memory(access.address, access.size);
  const Value after = result_of(operation, before, operand, access.size);
  write_memory(access.address, access.size, after);
  finish_update(me, *line, before != after);
  return before;
}

bool Machine::compare_exchange(const Access& access, Order failure, bool weak, Value& expected,
                               Value desired) {
  if (!timed_) return Tenant::compare_exchange(access, failure, weak, expected, desired);
  Thread& me = *me_;
  Line* line = at_hand(me, access.address, access.size, true);
  if (line == nullptr) line = &own(me, access, false);
  const Value before = read_memory(access.address, access.size);
  const bool equal = before == expected;
  if (equal) write_memory(access.address, access.size, desired);
  ++(equal ? counts_.swaps : counts_.failed_swaps);
  finish_update(me, *line, equal && before != desired);
  expected = before;
  return equal;
}

void Machine::fence(Order order, const void* /*pc*/) {
  if (!timed_ || order != Order::seq_cst) return;
  Thread& me = *me_;
  drain(me);
  me.clock += me.costs->rmw_hit;
}

// --- Stores ----------------------------------------------------------------------------------

// Stores take effect in program order. The first one's request is under way; the next one's is
// sent when that has been served, so that their transfers overlap but for the way to the line.
void Machine::issue_store(Thread& me, Time now) {
  const PostedStore& store = me.stores.first();
  me.store_request = {.issued = store.issued,
                      .pc = store.pc,
                      .bytes = store.bytes,
                      .takes = alone_.store_hit,
                      .thread = me.number,
                      .core = me.core,
                      .want = Want::ownership,
                      .posted = true};
  directory_.send(*store.line, me.store_request, now);
}

void Machine::post(Thread& me, Line& line, const Access& access, const Value* value) {
  if (me.stores.full()) {
    const Time since = me.clock;
    me.crowded = true;
    go_on();
    me.crowded = false;
    note_wait(Cause::stores, since, me.clock);
  }
  PostedStore& store = me.stores.add();
  store.line = &line;
  store.issued = me.clock;
  store.pc = access.pc;
  store.bytes = bytes_of(access.address, access.size);
  if (value != nullptr) {
    store.address = access.address;
    store.size = access.size;
    store.value = *value;
  }
  if (me.stores.size() == 1) issue_store(me, me.clock);
}

// The first store has its line, and takes effect: until `done` nobody else can look.
void Machine::commit_store(Thread& me, Line& line, Time done) {
  const PostedStore store = me.stores.first();
  if (store.size != 0) write_memory(store.address, store.size, store.value);
  line.written |= store.bytes;
  me.committed = std::max(me.committed, done) + alone_.store_hit;
  line.available = std::max(line.available, me.committed);
  me.stores.drop_first();
  if (!me.stores.empty()) issue_store(me, line.event.time);
  if (me.crowded || (me.draining && me.stores.empty())) {
    events_.push(me.event, std::max(me.committed, me.clock));
    me.crowded = me.draining = false;
  }
}

void Machine::wait_for_stores(Thread& me) {
  const Time since = me.clock;
  if (!me.stores.empty()) {
    me.draining = true;
    go_on();
  }
  me.clock = std::max(me.clock, me.committed);
  note_wait(Cause::stores, since, me.clock);
}

void Machine::store(const Access& access, Value value) {
  if (!timed_) {
    Tenant::store(access, value);
    return;
  }
  Thread& me = *me_;
  const bool strong = access.order == Order::seq_cst;  // an exchange, on x86
  if (strong) {
    Line& line = own(me, access, true);
    const bool changed = read_memory(access.address, access.size) != value;
    write_memory(access.address, access.size, value);
    finish_update(me, line, changed);
    return;
  }
  ++counts_.accesses;
  Line& line = line_of(me, access.address);
  sync(me, ahead_of(me, line));
  if (line.owner == me.core && me.stores.empty()) {
    watch(me, line);
    me.changes += read_memory(access.address, access.size) != value ? 1 : 0;
    write_memory(access.address, access.size, value);
    line.written |= bytes_of(access.address, access.size);
    line.available = std::max(line.available, me.clock);
  } else {
    ++me.changes;
    post(me, line, access, &value);
  }
  me.clock += me.costs->store_hit;
}

void Machine::plain_write(std::uintptr_t address, std::size_t size, const void* pc) {
  if (!timed_) return;
  Thread& me = *me_;
  if (address - me.stack < me.stack_bytes) {
    me.clock += me.costs->plain_op;
    return;
  }
  Line* line = at_hand(me, address, size, true);
  if (line == nullptr) {
    plain_write_late(me, address, size, pc);
    return;
  }
  ++me.changes;
  me.clock += me.costs->plain_op;
}

void Machine::plain_write_late(Thread& me, std::uintptr_t address, std::size_t size,
                               const void* pc) {
  ++me.changes;
  const std::uintptr_t end = address + size;
  while (address < end) {
    const auto part = static_cast<std::uint32_t>(
        std::min<std::size_t>(end - address, line_bytes - address % line_bytes));
    ++counts_.accesses;
    Line& line = line_of(me, address);
    sync(me, ahead_of(me, line));
    if (line.owner == me.core) {
      line.written |= bytes_of(address, part);
    } else if (me.stores.empty() || me.stores[me.stores.size() - 1].line != &line) {
      post(me, line, {address, part, Order::relaxed, pc}, nullptr);
    }
    me.clock += me.costs->plain_op;
    address += part;
  }
}

}  // namespace irt::many_core
