/// What an access to memory does in simulated time.
///
/// A core that has the line pays a hit. One that does not asks the directory for it, and the event
/// loop runs others until it is there. Stores wait in the thread's buffer instead
/// (posted_stores.hpp).
#pragma once

#include <cstddef>
#include <cstdint>

#include "bench/many_core/machine/event_loop.hpp"
#include "bench/many_core/machine/heap.hpp"
#include "bench/many_core/machine/memory.hpp"
#include "bench/many_core/machine/spin_loops.hpp"

namespace irt::many_core {

class Accesses {
 public:
  /// How far accesses to private lines may run ahead of other threads.
  static constexpr Time private_window = 200 * nanosecond;

  Accesses(const Profile& profile, EventLoop& loop, const Heap& heap);

  // As virtual_cores::Tenant has them, of the thread in progress.
  void plain_read(Thread& me, std::uintptr_t address, std::size_t size, const void* pc) {
    if (address - me.stack >= me.stack_bytes && !at_hand(me, find(address), address, size, false)) {
      plain_read_late(me, address, size, pc);
      return;
    }
    me.clock += me.costs->plain_op;
  }
  void plain_write(Thread& me, std::uintptr_t address, std::size_t size, const void* pc) {
    if (address - me.stack >= me.stack_bytes) {
      if (!at_hand(me, find(address), address, size, true)) {
        plain_write_late(me, address, size, pc);
        return;
      }
      ++me.changes;
    }
    me.clock += me.costs->plain_op;
  }
  virtual_cores::Value load(Thread& me, const virtual_cores::Access& access) {
    LoopState& loop = me.loop;
    const bool elsewhere = access.pc != loop.pc || access.address != loop.address;
    if (loop.age + 1 >= LoopState::longest || !elsewhere ||
        !at_hand(me, find(access.address), access.address, access.size, false))
      return load_late(me, access);
    ++loop.age;
    me.clock += me.costs->load_hit;
    return read_memory(access.address, access.size);
  }
  void store(Thread& me, const virtual_cores::Access& access, virtual_cores::Value value);
  virtual_cores::Value modify(Thread& me, const virtual_cores::Access& access,
                              virtual_cores::Modification operation, virtual_cores::Value operand);
  bool compare_exchange(Thread& me, const virtual_cores::Access& access,
                        virtual_cores::Value& expected, virtual_cores::Value desired);
  /// A full one.
  void fence(Thread& me);

  // What the kernel and the C library do besides.
  /// Reads a part of one line, at no cost but its way.
  void read(Thread& me, std::uintptr_t address, std::uint64_t bytes, const void* pc);
  /// Takes a lock that is held too shortly to be waited for in sleep. An addition (`arithmetic`)
  /// may be done far away.
  void take(Thread& me, std::uintptr_t address, bool arithmetic, const void* pc);
  /// Waits until all stores of the thread are done.
  void drain(Thread& me) {
    if (!me.stores.empty() || me.clock < me.committed) wait_for_stores(me);
  }

 private:
  [[nodiscard]] Line* find(std::uintptr_t address) const {
    return state_.directory.find(address / line_bytes);
  }
  Line& line_of(const Thread& me, std::uintptr_t address) {
    Line* line = find(address);
    return line != nullptr ? *line : new_line(me, address);
  }
  Line& new_line(const Thread& me, std::uintptr_t address);
  static Time ahead_of(const Thread& me, const Line& line) {
    return (line.only_mine && line.owner == me.core) || (line.only_read && line.held_by(me.core))
               ? private_window
               : 0;
  }
  // What nearly all accesses to private data are: the thread may use these bytes of the line at
  // once, for it holds it, its stores are done, nothing happens before its next step, and it is in
  // no loop. The access is counted. Else false, nothing is counted, and the slower way is taken
  // (the functions named `late`). `line` is null where nobody has used it yet.
  [[gnu::always_inline]] inline bool at_hand(const Thread& me, Line* line, std::uintptr_t address,
                                             std::size_t size, bool to_write) {
    if (line == nullptr || me.loop.rounds != 0) return false;
    if (!me.stores.empty() || me.clock < me.committed) return false;
    if (line->owner != me.core && (to_write || !line->sharers.has(me.core))) return false;
    if (address % line_bytes + size > line_bytes) return false;
    if (!state_.is_next(me, ahead_of(me, *line))) return false;
    ++state_.measurement.counts.accesses;
    (to_write ? line->written : line->read) |= bytes_of(address, size);
    return true;
  }
  virtual_cores::Value load_late(Thread& me, const virtual_cores::Access& access);
  void plain_read_late(Thread& me, std::uintptr_t address, std::size_t size, const void* pc);
  void plain_write_late(Thread& me, std::uintptr_t address, std::size_t size, const void* pc);
  void fetch(Thread& me, Line& line, Want want, const void* pc, std::uint64_t bytes);
  Line& own(Thread& me, Line* line, const virtual_cores::Access& access, bool arithmetic);
  static void finish_update(Thread& me, Line& line, bool changed) {
    me.changes += changed ? 1 : 0;
    if (line.owner != me.core) return;  // it was done at the home
    me.clock += me.costs->rmw_hit;
    line.available = std::max(line.available, me.clock);
  }
  void post(Thread& me, const PostedStore& store);
  void wait_for_stores(Thread& me);

  State& state_;
  EventLoop& loop_;
  const Heap& heap_;
  SpinLoops spin_loops_;
  bool far_atomics_;
};

}  // namespace irt::many_core
