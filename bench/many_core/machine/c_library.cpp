#include "bench/many_core/machine/c_library.hpp"

#include <algorithm>

namespace irt::many_core {

using virtual_cores::Access;
using virtual_cores::Modification;
using virtual_cores::Order;
using virtual_cores::Value;
using virtual_cores::Wake;

namespace {

// What a call executes besides its atomic operations, in plain accesses: counted in
// pthread_mutex_lock, and in malloc from the tcache.
constexpr Time lock_accesses = 8;
constexpr Time heap_accesses = 10;

}  // namespace

// --- Locks (lowlevellock.c) ---------------------------------------------------------------------

bool CLibrary::try_lock(Thread& me, std::uintptr_t address, const void* pc) {
  me.clock += lock_accesses * me.costs->plain_op;
  Value expected = 0;
  return accesses_.compare_exchange(me, {address, 4, Order::acquire, pc}, expected, 1);
}

bool CLibrary::lock(Thread& me, std::uintptr_t address, std::int64_t nanoseconds, const void* pc) {
  if (try_lock(me, address, pc)) return true;
  const Time end = me.clock + nanoseconds * nanosecond;
  const auto sleep = [&] {
    const std::int64_t left = nanoseconds < 0 ? -1 : std::max<Time>(end - me.clock, 0) / nanosecond;
    return kernel_.wait(me, address, 2, left, pc) != Wake::timed_out;
  };
  const Access access{address, 4, Order::acquire, pc};
  if (accesses_.load(me, access) == 2 && !sleep()) return false;
  while (accesses_.modify(me, access, Modification::exchange, 2) != 0)
    if (!sleep()) return false;
  return true;
}

void CLibrary::unlock(Thread& me, std::uintptr_t address, const void* pc) {
  me.clock += lock_accesses * me.costs->plain_op;
  const Access access{address, 4, Order::release, pc};
  if (accesses_.modify(me, access, Modification::exchange, 0) == 2)
    kernel_.wake(me, address, 1, pc);
}

// --- The allocator ------------------------------------------------------------------------------

void* CLibrary::allocate(Thread& me, std::size_t size, std::size_t alignment, const void* pc) {
  Heap::Traffic traffic;
  void* block = heap_.allocate(me.number, size, alignment, pc, traffic);
  charge(me, traffic, pc);
  return block;
}

void CLibrary::release(Thread& me, void* block, const void* pc) {
  Heap::Traffic traffic;
  heap_.release(me.number, block, traffic);
  charge(me, traffic, pc);
}

void CLibrary::charge(Thread& me, const Heap::Traffic& traffic, const void* pc) {
  me.clock += heap_accesses * me.costs->plain_op;
  ++me.changes;
  if (traffic.locked == 0) return;
  accesses_.take(me, traffic.locked, false, pc);
  if (traffic.linked != 0) accesses_.plain_read(me, traffic.linked, 8, pc);
  me.clock += me.costs->rmw_hit;  // the lock is released
}

}  // namespace irt::many_core
