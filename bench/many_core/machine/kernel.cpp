#include "bench/many_core/machine/kernel.hpp"

#include <algorithm>

namespace irt::many_core {

using virtual_cores::Wake;

namespace {

// Where the kernel keeps the list of sleepers of a word: a line for each, in a place of its own.
constexpr std::uintptr_t buckets_address = 0x180000000000;

}  // namespace

Kernel::Kernel(const Profile& profile, EventLoop& loop, Accesses& accesses)
    : loop_(loop),
      accesses_(accesses),
      syscall_(picoseconds(profile.syscall)),
      futex_wait_(picoseconds(profile.futex_wait)),
      wake_call_(picoseconds(profile.wake_call)) {}

Sleepers& Kernel::sleepers_of(std::uintptr_t address) {
  const auto [found, fresh] = sleepers_.try_emplace(address);
  if (fresh) found->second.bucket = buckets_address + line_bytes * sleepers_.size();
  return found->second;
}

Wake Kernel::wait(Thread& me, std::uintptr_t address, std::uint32_t expected,
                  std::int64_t nanoseconds, const void* pc) {
  me.clock += syscall_;
  Sleepers& sleepers = sleepers_of(address);
  accesses_.take(me, sleepers.bucket, true, pc);
  // The kernel looks at the word while it holds the bucket.
  accesses_.read(me, address, bytes_of(address, 4), pc);
  if (read_memory(address, 4) != expected) return Wake::value_differs;
  sleepers.threads.push_back(me.number);
  ++loop_.state().measurement.counts.sleeps;
  me.clock += futex_wait_;
  park(me, &sleepers, nanoseconds < 0 ? never : me.clock + nanoseconds * nanosecond);
  return me.timed_out ? Wake::timed_out : Wake::woken;
}

unsigned Kernel::wake(Thread& me, std::uintptr_t address, unsigned count, const void* pc) {
  accesses_.drain(me);
  me.clock += syscall_;
  Sleepers& sleepers = sleepers_of(address);
  accesses_.read(me, sleepers.bucket, bytes_of(sleepers.bucket, 4), pc);
  if (sleepers.threads.empty()) return 0;
  accesses_.take(me, sleepers.bucket, true, pc);
  unsigned woken = 0;
  while (woken < count && !sleepers.threads.empty()) {
    Thread& thread = loop_.state().threads[sleepers.threads.front()];
    sleepers.threads.pop_front();
    me.clock += wake_call_;
    loop_.run_queues().wake(thread, me.clock);
    ++woken;
  }
  return woken;
}

void Kernel::yield(Thread& me) {
  me.clock += syscall_;
  loop_.sync(me);
  loop_.give_way(me);
}

void Kernel::sleep(Thread& me, std::int64_t nanoseconds) {
  me.clock += syscall_;
  park(me, nullptr, me.clock + std::max<std::int64_t>(nanoseconds, 0) * nanosecond);
}

// Sleeps until somebody wakes the thread, or until a moment.
void Kernel::park(Thread& me, Sleepers* among, Time until) {
  accesses_.drain(me);
  me.asleep_among = among;
  me.parked = true;
  me.woken = me.timed_out = false;
  if (until != never) loop_.state().events.push(me.event, until);
  loop_.run_queues().leave(me);
  loop_.wait();
  me.parked = false;
  ++me.changes;
}

}  // namespace irt::many_core
