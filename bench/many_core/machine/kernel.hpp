/// What threads ask of the kernel: futexes, sleep, the processor for others.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "bench/many_core/machine/accesses.hpp"

namespace irt::many_core {

class Kernel {
 public:
  Kernel(const Profile& profile, EventLoop& loop, Accesses& accesses);

  // As virtual_cores::Tenant has them, of the thread in progress.
  virtual_cores::Wake wait(Thread& me, std::uintptr_t address, std::uint32_t expected,
                           std::int64_t nanoseconds, const void* pc);
  unsigned wake(Thread& me, std::uintptr_t address, unsigned count, const void* pc);
  void yield(Thread& me);
  void sleep(Thread& me, std::int64_t nanoseconds);

 private:
  Sleepers& sleepers_of(std::uintptr_t address);
  void park(Thread& me, Sleepers* among, Time until);

  EventLoop& loop_;
  Accesses& accesses_;
  Time syscall_, futex_wait_, wake_call_;
  std::unordered_map<std::uintptr_t, Sleepers> sleepers_;  // by the word that they sleep at
};

}  // namespace irt::many_core
