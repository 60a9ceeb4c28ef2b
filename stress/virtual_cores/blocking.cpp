// Mutexes, condition variables, semaphores, rw locks, barriers, once-flags and futexes of
// instrumented code, in terms of the tenant's lock, wait and wake.
//
// The objects keep the C library's size and its static initialisers (zero but for a mutex's kind).

#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstring>
#include <ctime>
#include <linux/futex.h>
#include <mutex>
#include <semaphore.h>
#include <sys/syscall.h>

#include "stress/virtual_cores/internal.hpp"

namespace {

using irt::virtual_cores::active;
using irt::virtual_cores::address_of;
using irt::virtual_cores::announce_write;
using irt::virtual_cores::ask;
using irt::virtual_cores::core_errno;
using irt::virtual_cores::current_core;
using irt::virtual_cores::fill_randomly;
using irt::virtual_cores::Operation;
using irt::virtual_cores::Order;
using irt::virtual_cores::Value;
using irt::virtual_cores::Wake;

#define IRT_PC __builtin_return_address(0)

/// Whom these functions ask: the registers that the code had at an atomic operation of before are
/// not those that it has now.
irt::virtual_cores::Tenant& tenant() {
  irt::virtual_cores::forget_registers();
  return *active;
}

constexpr std::int64_t forever = -1;
constexpr unsigned everybody = INT_MAX;

std::uint32_t load(const std::uint32_t& word, const void* pc) {
  return static_cast<std::uint32_t>(tenant().load({address_of(&word), 4, Order::acquire, pc}));
}
void store(std::uint32_t& word, std::uint32_t value, const void* pc) {
  tenant().store({address_of(&word), 4, Order::release, pc}, value);
}
std::uint32_t add(std::uint32_t& word, std::uint32_t value, const void* pc) {
  return static_cast<std::uint32_t>(
      tenant().modify({address_of(&word), 4, Order::acq_rel, pc}, Operation::add, value));
}
bool swap_if(std::uint32_t& word, std::uint32_t expected, std::uint32_t desired, const void* pc) {
  Value seen = expected;
  return tenant().compare_exchange({address_of(&word), 4, Order::acq_rel, pc}, Order::acquire,
                                   false, seen, desired);
}

// Zeroes an object that the code has made.
template <class T>
void clear(T& object, const void* pc) {
  announce_write(&object, sizeof object, pc);
  std::memset(&object, 0, sizeof object);
}

// How long until `deadline`; never negative, for that means forever.
std::int64_t until(const timespec* deadline) {
  const std::int64_t left =
      deadline->tv_sec * std::int64_t{1'000'000'000} + deadline->tv_nsec - tenant().now();
  return left < 0 ? 0 : left;
}

// pthread_mutex_t: the kind is where glibc keeps it, the owner is only used by recursive mutexes.
struct Mutex {
  std::uint32_t word;
  std::uint32_t depth;
  std::uint32_t owner;  // core + 1
  std::uint32_t unused;
  std::uint32_t kind;

  std::uintptr_t address() const { return address_of(&word); }
  bool recursive() const { return (kind & 3U) == PTHREAD_MUTEX_RECURSIVE; }
};

Mutex& mutex_of(pthread_mutex_t* mutex, const void* pc) {
  ask(mutex, sizeof *mutex, pc);
  return *reinterpret_cast<Mutex*>(mutex);
}

int lock(Mutex& mutex, const void* pc) {
  if (mutex.recursive() && mutex.owner == current_core + 1) {
    ++mutex.depth;
    return 0;
  }
  tenant().lock(mutex.address(), pc);
  mutex.owner = current_core + 1;
  return 0;
}

int try_lock(Mutex& mutex, const void* pc) {
  if (mutex.recursive() && mutex.owner == current_core + 1) {
    ++mutex.depth;
    return 0;
  }
  if (!tenant().try_lock(mutex.address(), pc)) return EBUSY;
  mutex.owner = current_core + 1;
  return 0;
}

int unlock(Mutex& mutex, const void* pc) {
  if (mutex.owner != current_core + 1)
    tenant().failed("a mutex is unlocked by a thread that does not hold it", pc);
  if (mutex.depth != 0) {
    --mutex.depth;
    return 0;
  }
  mutex.owner = 0;
  tenant().unlock(mutex.address(), pc);
  return 0;
}

// pthread_cond_t: a word that every notification changes.
std::uint32_t& sequence_of(pthread_cond_t* condition, const void* pc) {
  ask(condition, sizeof *condition, pc);
  return *reinterpret_cast<std::uint32_t*>(condition);
}

int condition_wait(pthread_cond_t* condition, Mutex& mutex, std::int64_t nanoseconds,
                   const void* pc) {
  std::uint32_t& sequence = sequence_of(condition, pc);
  const std::uint32_t seen = load(sequence, pc);
  unlock(mutex, pc);
  const Wake wake = tenant().wait(address_of(&sequence), seen, nanoseconds, pc);
  lock(mutex, pc);
  return wake == Wake::timed_out ? ETIMEDOUT : 0;
}

int condition_notify(pthread_cond_t* condition, unsigned count, const void* pc) {
  add(sequence_of(condition, pc), 1, pc);
  tenant().wake(address_of(condition), count, pc);
  return 0;
}

// pthread_rwlock_t: readers, or all bits for a writer.
constexpr std::uint32_t writer = ~0U;
std::uint32_t& word_of(pthread_rwlock_t* lock, const void* pc) {
  ask(lock, sizeof *lock, pc);
  return *reinterpret_cast<std::uint32_t*>(lock);
}

// sem_t: the count.
std::uint32_t& count_of(sem_t* semaphore, const void* pc) {
  ask(semaphore, sizeof *semaphore, pc);
  return *reinterpret_cast<std::uint32_t*>(semaphore);
}

bool take(std::uint32_t& count, const void* pc) {
  for (std::uint32_t seen = load(count, pc); seen != 0; seen = load(count, pc))
    if (swap_if(count, seen, seen - 1, pc)) return true;
  return false;
}

// pthread_barrier_t: who is missing, the round, how many it takes.
struct Barrier {
  std::uint32_t missing;
  std::uint32_t round;
  std::uint32_t total;
};

// A function-local static's guard: byte 0 says that it is made, the upper half is a lock.
struct Guard {
  std::uint8_t made;
  std::uint8_t unused[3];
  std::uint32_t lock;
};

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)

// --- Mutexes and spin locks ------------------------------------------------------------------

IRT_REDIRECTED int irt_vc_pthread_mutex_init(pthread_mutex_t* m, const pthread_mutexattr_t* kind) {
  clear(*m, IRT_PC);
  int type = 0;
  if (kind != nullptr) pthread_mutexattr_gettype(kind, &type);
  mutex_of(m, IRT_PC).kind = static_cast<std::uint32_t>(type);
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_mutex_destroy(pthread_mutex_t*) {
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_mutex_lock(pthread_mutex_t* m) {
  return lock(mutex_of(m, IRT_PC), IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_mutex_trylock(pthread_mutex_t* m) {
  return try_lock(mutex_of(m, IRT_PC), IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_mutex_unlock(pthread_mutex_t* m) {
  return unlock(mutex_of(m, IRT_PC), IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_spin_init(pthread_spinlock_t* s, int) {
  announce_write(const_cast<int*>(s), sizeof *s, IRT_PC);
  *s = 0;
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_spin_destroy(pthread_spinlock_t*) {
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_spin_lock(pthread_spinlock_t* s) {
  tenant().lock(address_of(s), IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_spin_trylock(pthread_spinlock_t* s) {
  return tenant().try_lock(address_of(s), IRT_PC) ? 0 : EBUSY;
}
IRT_REDIRECTED int irt_vc_pthread_spin_unlock(pthread_spinlock_t* s) {
  tenant().unlock(address_of(s), IRT_PC);
  return 0;
}

// --- Condition variables ---------------------------------------------------------------------

IRT_REDIRECTED int irt_vc_pthread_cond_init(pthread_cond_t* c, const pthread_condattr_t*) {
  clear(*c, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_cond_destroy(pthread_cond_t*) {
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_cond_wait(pthread_cond_t* c, pthread_mutex_t* m) {
  return condition_wait(c, mutex_of(m, IRT_PC), forever, IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_cond_timedwait(pthread_cond_t* c, pthread_mutex_t* m,
                                                 const timespec* deadline) {
  return condition_wait(c, mutex_of(m, IRT_PC), until(deadline), IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_cond_clockwait(pthread_cond_t* c, pthread_mutex_t* m, clockid_t,
                                                 const timespec* deadline) {
  return condition_wait(c, mutex_of(m, IRT_PC), until(deadline), IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_cond_signal(pthread_cond_t* c) {
  return condition_notify(c, 1, IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_cond_broadcast(pthread_cond_t* c) {
  return condition_notify(c, everybody, IRT_PC);
}
// std::condition_variable's members that libstdc++ keeps in its shared object.
IRT_REDIRECTED void irt_vc__ZNSt18condition_variableC1Ev(pthread_cond_t* c) {
  clear(*c, IRT_PC);
}
IRT_REDIRECTED void irt_vc__ZNSt18condition_variableD1Ev(pthread_cond_t*) {}
IRT_REDIRECTED void irt_vc__ZNSt18condition_variable4waitERSt11unique_lockISt5mutexE(
    pthread_cond_t* c, std::unique_lock<std::mutex>& held) {
  condition_wait(c, mutex_of(held.mutex()->native_handle(), IRT_PC), forever, IRT_PC);
}
IRT_REDIRECTED void irt_vc__ZNSt18condition_variable10notify_oneEv(pthread_cond_t* c) {
  condition_notify(c, 1, IRT_PC);
}
IRT_REDIRECTED void irt_vc__ZNSt18condition_variable10notify_allEv(pthread_cond_t* c) {
  condition_notify(c, everybody, IRT_PC);
}

// --- Semaphores, rw locks, barriers ----------------------------------------------------------

IRT_REDIRECTED int irt_vc_sem_init(sem_t* s, int, unsigned count) {
  clear(*s, IRT_PC);
  count_of(s, IRT_PC) = count;
  return 0;
}
IRT_REDIRECTED int irt_vc_sem_destroy(sem_t*) {
  return 0;
}
IRT_REDIRECTED int irt_vc_sem_post(sem_t* s) {
  add(count_of(s, IRT_PC), 1, IRT_PC);
  tenant().wake(address_of(s), 1, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_sem_wait(sem_t* s) {
  while (!take(count_of(s, IRT_PC), IRT_PC)) tenant().wait(address_of(s), 0, forever, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_sem_trywait(sem_t* s) {
  if (take(count_of(s, IRT_PC), IRT_PC)) return 0;
  core_errno() = EAGAIN;
  return -1;
}

IRT_REDIRECTED int irt_vc_pthread_rwlock_init(pthread_rwlock_t* l, const pthread_rwlockattr_t*) {
  clear(*l, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_rwlock_destroy(pthread_rwlock_t*) {
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_rwlock_tryrdlock(pthread_rwlock_t* l) {
  for (std::uint32_t seen = load(word_of(l, IRT_PC), IRT_PC); seen != writer;
       seen = load(word_of(l, IRT_PC), IRT_PC))
    if (swap_if(word_of(l, IRT_PC), seen, seen + 1, IRT_PC)) return 0;
  return EBUSY;
}
IRT_REDIRECTED int irt_vc_pthread_rwlock_rdlock(pthread_rwlock_t* l) {
  while (irt_vc_pthread_rwlock_tryrdlock(l) != 0)
    tenant().wait(address_of(l), writer, forever, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_rwlock_trywrlock(pthread_rwlock_t* l) {
  return swap_if(word_of(l, IRT_PC), 0, writer, IRT_PC) ? 0 : EBUSY;
}
IRT_REDIRECTED int irt_vc_pthread_rwlock_wrlock(pthread_rwlock_t* l) {
  while (!swap_if(word_of(l, IRT_PC), 0, writer, IRT_PC)) {
    const std::uint32_t seen = load(word_of(l, IRT_PC), IRT_PC);
    if (seen != 0) tenant().wait(address_of(l), seen, forever, IRT_PC);
  }
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_rwlock_unlock(pthread_rwlock_t* l) {
  const std::uint32_t seen = load(word_of(l, IRT_PC), IRT_PC);
  if (seen == writer)
    store(word_of(l, IRT_PC), 0, IRT_PC);
  else
    add(word_of(l, IRT_PC), ~0U, IRT_PC);
  tenant().wake(address_of(l), everybody, IRT_PC);
  return 0;
}

IRT_REDIRECTED int irt_vc_pthread_barrier_init(pthread_barrier_t* b, const pthread_barrierattr_t*,
                                               unsigned count) {
  clear(*b, IRT_PC);
  *reinterpret_cast<Barrier*>(b) = {count, 0, count};
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_barrier_destroy(pthread_barrier_t*) {
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_barrier_wait(pthread_barrier_t* b) {
  ask(b, sizeof *b, IRT_PC);
  Barrier& barrier = *reinterpret_cast<Barrier*>(b);
  const std::uint32_t round = load(barrier.round, IRT_PC);
  if (add(barrier.missing, ~0U, IRT_PC) == 1) {
    store(barrier.missing, barrier.total, IRT_PC);
    add(barrier.round, 1, IRT_PC);
    tenant().wake(address_of(&barrier.round), everybody, IRT_PC);
    return PTHREAD_BARRIER_SERIAL_THREAD;
  }
  while (load(barrier.round, IRT_PC) == round)
    tenant().wait(address_of(&barrier.round), round, forever, IRT_PC);
  return 0;
}

// --- Once ------------------------------------------------------------------------------------

IRT_REDIRECTED int irt_vc___cxa_guard_acquire(Guard* guard) {
  tenant().lock(address_of(&guard->lock), IRT_PC);
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

// --- Futex -----------------------------------------------------------------------------------

IRT_REDIRECTED long irt_vc_syscall(long number, ...) {
  std::va_list arguments;
  va_start(arguments, number);
  const auto address = va_arg(arguments, std::uintptr_t);
  const auto second = va_arg(arguments, std::uint64_t);
  const int operation = static_cast<int>(second) & FUTEX_CMD_MASK;
  const auto value = va_arg(arguments, std::uint32_t);
  const auto* time = va_arg(arguments, const timespec*);
  va_end(arguments);
  if (number == SYS_gettid) return current_core + 1L;
  if (number == SYS_getrandom) {
    auto* bytes = reinterpret_cast<unsigned char*>(address);  // NOLINT: as the kernel is given it
    const auto size = static_cast<std::size_t>(second);
    fill_randomly(bytes, size, IRT_PC);
    return static_cast<long>(size);
  }
  if (number == SYS_futex && (operation == FUTEX_WAKE || operation == FUTEX_WAKE_BITSET))
    return tenant().wake(address, value, IRT_PC);
  if (number == SYS_futex && (operation == FUTEX_WAIT || operation == FUTEX_WAIT_BITSET)) {
    std::int64_t nanoseconds = forever;
    if (time != nullptr)  // relative for FUTEX_WAIT, a deadline for FUTEX_WAIT_BITSET
      nanoseconds =
          operation == FUTEX_WAIT ? time->tv_sec * 1'000'000'000 + time->tv_nsec : until(time);
    switch (tenant().wait(address, value, nanoseconds, IRT_PC)) {
      case Wake::woken:
        return 0;
      case Wake::value_differs:
        core_errno() = EAGAIN;
        return -1;
      case Wake::timed_out:
        core_errno() = ETIMEDOUT;
        return -1;
    }
  }
  irt::virtual_cores::Tenant::refuse("the code makes system call " + std::to_string(number) +
                                     ", which virtual cores do not support");
}

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
