// What instrumented code does once: statics of functions, pthread_once, std::call_once, call_once.

#include <pthread.h>

#include "stress/virtual_cores/words.hpp"

namespace {

using irt::virtual_cores::address_of;
using irt::virtual_cores::forever;
using irt::virtual_cores::Order;
using namespace irt::virtual_cores::words;

// A function-local static's guard: byte 0 says that it is made, the upper half is a lock.
struct Guard {
  std::uint8_t made;
  std::uint8_t unused[3];
  std::uint32_t lock;
};

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)

IRT_REDIRECTED int irt_vc___cxa_guard_acquire(Guard* guard) {
  tenant().lock(address_of(&guard->lock), forever, IRT_PC);
  if (tenant().load({address_of(&guard->made), 1, Order::acquire, IRT_PC}) == 0) return 1;
  tenant().unlock(address_of(&guard->lock), IRT_PC);
  return 0;
}
IRT_REDIRECTED void irt_vc___cxa_guard_release(Guard* guard) {
  tenant().store({address_of(&guard->made), 1, Order::release, IRT_PC}, 1);
  tenant().unlock(address_of(&guard->lock), IRT_PC);
}
IRT_REDIRECTED void irt_vc___cxa_guard_abort(Guard* guard) {
  tenant().unlock(address_of(&guard->lock), IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_once(pthread_once_t* once, void (*function)()) {
  auto& state = *reinterpret_cast<std::uint32_t*>(once);  // 0 fresh, 1 in progress, 2 done
  const void* const pc = IRT_PC;
  const auto become = [&](std::uint32_t next) {
    store(state, next, pc);
    tenant().wake(address_of(once), everybody, pc);
  };
  while (!swap_if(state, 0, 1, pc)) {
    const std::uint32_t seen = load(state, pc);
    if (seen == 2) return 0;
    if (seen == 1) tenant().wait(address_of(once), 1, forever, pc);
  }
  try {
    function();
  } catch (...) {  // of std::call_once: the next caller tries again
    become(0);
    throw;
  }
  become(2);
  return 0;
}
// C11's answers nothing.
asm(".globl irt_vc_call_once\n.set irt_vc_call_once, irt_vc_pthread_once");

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
