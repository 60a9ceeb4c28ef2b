// Mutexes, condition variables, semaphores, rw locks and barriers of instrumented code,
// POSIX's and C11's, in terms of the tenant's lock, wait and wake.
//
// The objects keep the C library's size and its static initialisers (zero but for a mutex's kind).

#include <cerrno>
#include <climits>
#include <cstring>
#include <ctime>
#include <mutex>
#include <optional>
#include <semaphore.h>
#include <string>
#include <threads.h>

#include "stress/virtual_cores/internal.hpp"
#include "stress/virtual_cores/words.hpp"

namespace {

using irt::virtual_cores::address_of;
using irt::virtual_cores::announce_write;
using irt::virtual_cores::ask;
using irt::virtual_cores::current_core;
using irt::virtual_cores::forever;
using irt::virtual_cores::set_errno;
using irt::virtual_cores::until;
using irt::virtual_cores::Wake;
using namespace irt::virtual_cores::words;

// What an object holds in a word that it does not need otherwise, once it was destroyed.
constexpr std::uint32_t destroyed = 0xDE57205E;

// Zeroes an object that the code has made.
template <class T>
void clear(T& object, const void* pc) {
  announce_write(&object, sizeof object, pc);
  std::memset(&object, 0, sizeof object);
}

// pthread_mutex_t: the kind is where glibc keeps it, the owner is only used by recursive mutexes.
struct Mutex {
  std::uint32_t word;
  std::uint32_t depth;
  std::uint32_t owner;  // core + 1
  std::uint32_t unused;
  std::uint32_t kind;

  [[nodiscard]] std::uintptr_t address() const { return address_of(&word); }
  [[nodiscard]] bool recursive() const { return (kind & 3U) == PTHREAD_MUTEX_RECURSIVE; }
};

Mutex& mutex_of(pthread_mutex_t* mutex, const void* pc) {
  ask(mutex, sizeof *mutex, pc);
  return *reinterpret_cast<Mutex*>(mutex);
}

// Of this and the like: asked after the event that comes after the destruction or before it.
void expect(const Mutex& mutex, const void* pc) {
  if (mutex.kind == destroyed) tenant().failed("a mutex is used that was destroyed", pc);
}

int lock(Mutex& mutex, std::int64_t nanoseconds, const void* pc) {
  if (mutex.recursive() && mutex.owner == current_core + 1) {
    ++mutex.depth;
    return 0;
  }
  const bool locked = tenant().lock(mutex.address(), nanoseconds, pc);
  expect(mutex, pc);
  if (!locked) return ETIMEDOUT;
  mutex.owner = current_core + 1;
  return 0;
}

int try_lock(Mutex& mutex, const void* pc) {
  if (mutex.recursive() && mutex.owner == current_core + 1) {
    ++mutex.depth;
    return 0;
  }
  const bool locked = tenant().try_lock(mutex.address(), pc);
  expect(mutex, pc);
  if (!locked) return EBUSY;
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

// Condition variables, rw locks and semaphores: one word that all of it is in, and one that says
// whether it was destroyed.
struct Object {
  std::uint32_t word;
  std::uint32_t end;
};
template <class T>
Object& object_of(T* object, const void* pc) {
  ask(object, sizeof *object, pc);
  return *reinterpret_cast<Object*>(object);
}
void expect(const Object& object, const char* name, const void* pc) {
  if (object.end == destroyed)
    tenant().failed(std::string(name) + " is used that was destroyed", pc);
}
void destroy(Object& object, const char* name, const void* pc) {
  expect(object, name, pc);
  object.end = destroyed;
}

// pthread_cond_t: a word that every notification changes.
constexpr const char* condition_name = "a condition variable";
// Who was woken may still be on its way out of it.
void condition_destroy(pthread_cond_t* condition, const void* pc) {
  Object& object = object_of(condition, pc);
  add(object.word, 0, pc);
  destroy(object, condition_name, pc);
}

int condition_wait(pthread_cond_t* condition, Mutex& mutex, std::int64_t nanoseconds,
                   const void* pc) {
  Object& object = object_of(condition, pc);
  const std::uint32_t seen = load(object.word, pc);
  expect(object, condition_name, pc);
  unlock(mutex, pc);
  const Wake wake = tenant().wait(address_of(&object.word), seen, nanoseconds, pc);
  lock(mutex, forever, pc);
  return wake == Wake::timed_out ? ETIMEDOUT : 0;
}

int condition_notify(pthread_cond_t* condition, unsigned count, const void* pc) {
  Object& object = object_of(condition, pc);
  add(object.word, 1, pc);
  expect(object, condition_name, pc);
  tenant().wake(address_of(condition), count, pc);
  return 0;
}

// pthread_rwlock_t: readers, or all bits for a writer.
constexpr std::uint32_t writer = ~0U;
constexpr const char* rwlock_name = "a read-write lock";

// sem_t: the count.
constexpr const char* semaphore_name = "a semaphore";

// Each of these takes what `word` stands for, or returns what it holds instead.
using Held = std::optional<std::uint32_t>;
Held take_one(std::uint32_t& count, const void* pc) {
  for (std::uint32_t seen = load(count, pc); seen != 0; seen = load(count, pc))
    if (swap_if(count, seen, seen - 1, pc)) return {};
  return 0;
}
Held take_to_read(std::uint32_t& word, const void* pc) {
  for (std::uint32_t seen = load(word, pc); seen != writer; seen = load(word, pc))
    if (swap_if(word, seen, seen + 1, pc)) return {};
  return writer;
}
Held take_to_write(std::uint32_t& word, const void* pc) {
  while (!swap_if(word, 0, writer, pc))
    if (const std::uint32_t seen = load(word, pc); seen != 0) return seen;
  return {};
}

// What is taken, and of what.
struct Taking {
  Held (*from)(std::uint32_t& word, const void* pc);
  const char* name;
};
constexpr Taking permit{take_one, semaphore_name};
constexpr Taking reading{take_to_read, rwlock_name};
constexpr Taking writing{take_to_write, rwlock_name};

Held take(Object& object, const Taking& taking, const void* pc) {
  const Held held = taking.from(object.word, pc);
  expect(object, taking.name, pc);
  return held;
}

// Sleeps at `object` until it is taken, or until the deadline if there is one.
int take_in_time(Object& object, const Taking& taking, const timespec* deadline, const void* pc) {
  while (const Held held = take(object, taking, pc))
    if (tenant().wait(address_of(&object.word), *held, until(deadline), pc) == Wake::timed_out)
      return ETIMEDOUT;
  return 0;
}

// pthread_barrier_t: who is missing, the round, how many it takes; 0 once it was destroyed.
struct Barrier {
  std::uint32_t missing;
  std::uint32_t round;
  std::uint32_t total;
};
Barrier& barrier_of(pthread_barrier_t* barrier, const void* pc) {
  ask(barrier, sizeof *barrier, pc);
  return *reinterpret_cast<Barrier*>(barrier);
}
void expect(const Barrier& barrier, const void* pc) {
  if (barrier.total == 0)
    tenant().failed("a barrier is used that was destroyed, or never initialised", pc);
}

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
IRT_REDIRECTED int irt_vc_pthread_mutex_destroy(pthread_mutex_t* m) {
  Mutex& mutex = mutex_of(m, IRT_PC);
  if (exchange(mutex.word, 0, IRT_PC) != 0)
    tenant().failed("a mutex is destroyed that somebody holds", IRT_PC);
  expect(mutex, IRT_PC);
  mutex.kind = destroyed;
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_mutex_lock(pthread_mutex_t* m) {
  return lock(mutex_of(m, IRT_PC), forever, IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_mutex_timedlock(pthread_mutex_t* m, const timespec* deadline) {
  return lock(mutex_of(m, IRT_PC), until(deadline), IRT_PC);
}
IRT_REDIRECTED int irt_vc_pthread_mutex_clocklock(pthread_mutex_t* m, clockid_t,
                                                  const timespec* deadline) {
  return lock(mutex_of(m, IRT_PC), until(deadline), IRT_PC);
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
IRT_REDIRECTED int irt_vc_pthread_spin_destroy(pthread_spinlock_t* s) {
  if (!tenant().try_lock(address_of(s), IRT_PC))
    tenant().failed("a spin lock is destroyed that somebody holds", IRT_PC);
  tenant().unlock(address_of(s), IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_spin_lock(pthread_spinlock_t* s) {
  tenant().lock(address_of(s), forever, IRT_PC);
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
IRT_REDIRECTED int irt_vc_pthread_cond_destroy(pthread_cond_t* c) {
  condition_destroy(c, IRT_PC);
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
IRT_REDIRECTED void irt_vc__ZNSt18condition_variableD1Ev(pthread_cond_t* c) {
  condition_destroy(c, IRT_PC);
}
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
  object_of(s, IRT_PC).word = count;
  return 0;
}
IRT_REDIRECTED int irt_vc_sem_destroy(sem_t* s) {
  Object& object = object_of(s, IRT_PC);
  add(object.word, 0, IRT_PC);
  destroy(object, semaphore_name, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_sem_post(sem_t* s) {
  Object& object = object_of(s, IRT_PC);
  add(object.word, 1, IRT_PC);
  expect(object, semaphore_name, IRT_PC);
  tenant().wake(address_of(s), 1, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_sem_wait(sem_t* s) {
  return take_in_time(object_of(s, IRT_PC), permit, nullptr, IRT_PC);
}
IRT_REDIRECTED int irt_vc_sem_timedwait(sem_t* s, const timespec* deadline) {
  return set_errno(take_in_time(object_of(s, IRT_PC), permit, deadline, IRT_PC));
}
IRT_REDIRECTED int irt_vc_sem_clockwait(sem_t* s, clockid_t, const timespec* deadline) {
  return set_errno(take_in_time(object_of(s, IRT_PC), permit, deadline, IRT_PC));
}
IRT_REDIRECTED int irt_vc_sem_trywait(sem_t* s) {
  return set_errno(take(object_of(s, IRT_PC), permit, IRT_PC) ? EAGAIN : 0);
}
IRT_REDIRECTED int irt_vc_sem_getvalue(sem_t* s, int* value) {
  const std::uint32_t count = load(object_of(s, IRT_PC).word, IRT_PC);
  announce_write(value, sizeof *value, IRT_PC);
  *value = static_cast<int>(count);
  return 0;
}

IRT_REDIRECTED int irt_vc_pthread_rwlock_init(pthread_rwlock_t* l, const pthread_rwlockattr_t*) {
  clear(*l, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_rwlock_destroy(pthread_rwlock_t* l) {
  Object& object = object_of(l, IRT_PC);
  if (exchange(object.word, 0, IRT_PC) != 0)
    tenant().failed("a read-write lock is destroyed that somebody holds", IRT_PC);
  destroy(object, rwlock_name, IRT_PC);
  return 0;
}
#define IRT_TAKE(kind, taking)                                                               \
  IRT_REDIRECTED int irt_vc_pthread_rwlock_try##kind##lock(pthread_rwlock_t* l) {            \
    return take(object_of(l, IRT_PC), taking, IRT_PC) ? EBUSY : 0;                           \
  }                                                                                          \
  IRT_REDIRECTED int irt_vc_pthread_rwlock_##kind##lock(pthread_rwlock_t* l) {               \
    return take_in_time(object_of(l, IRT_PC), taking, nullptr, IRT_PC);                      \
  }                                                                                          \
  IRT_REDIRECTED int irt_vc_pthread_rwlock_timed##kind##lock(pthread_rwlock_t* l,            \
                                                             const timespec* deadline) {     \
    return take_in_time(object_of(l, IRT_PC), taking, deadline, IRT_PC);                     \
  }                                                                                          \
  IRT_REDIRECTED int irt_vc_pthread_rwlock_clock##kind##lock(pthread_rwlock_t* l, clockid_t, \
                                                             const timespec* deadline) {     \
    return take_in_time(object_of(l, IRT_PC), taking, deadline, IRT_PC);                     \
  }
IRT_TAKE(rd, reading)
IRT_TAKE(wr, writing)
#undef IRT_TAKE
IRT_REDIRECTED int irt_vc_pthread_rwlock_unlock(pthread_rwlock_t* l) {
  std::uint32_t& word = object_of(l, IRT_PC).word;
  const std::uint32_t seen = load(word, IRT_PC);
  if (seen == 0) tenant().failed("a read-write lock is unlocked that nobody holds", IRT_PC);
  if (seen == writer)
    store(word, 0, IRT_PC);
  else
    add(word, ~0U, IRT_PC);
  tenant().wake(address_of(l), everybody, IRT_PC);
  return 0;
}

IRT_REDIRECTED int irt_vc_pthread_barrier_init(pthread_barrier_t* b, const pthread_barrierattr_t*,
                                               unsigned count) {
  clear(*b, IRT_PC);
  *reinterpret_cast<Barrier*>(b) = {count, 0, count};
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_barrier_destroy(pthread_barrier_t* b) {
  Barrier& barrier = barrier_of(b, IRT_PC);
  if (exchange(barrier.missing, barrier.total, IRT_PC) != barrier.total)
    tenant().failed("a barrier is destroyed that somebody waits at", IRT_PC);
  expect(barrier, IRT_PC);
  barrier.total = 0;
  return 0;
}
IRT_REDIRECTED int irt_vc_pthread_barrier_wait(pthread_barrier_t* b) {
  Barrier& barrier = barrier_of(b, IRT_PC);
  const std::uint32_t round = load(barrier.round, IRT_PC);
  const std::uint32_t missing = add(barrier.missing, ~0U, IRT_PC);
  expect(barrier, IRT_PC);
  if (missing == 1) {
    store(barrier.missing, barrier.total, IRT_PC);
    add(barrier.round, 1, IRT_PC);
    tenant().wake(address_of(&barrier.round), everybody, IRT_PC);
    return PTHREAD_BARRIER_SERIAL_THREAD;
  }
  while (load(barrier.round, IRT_PC) == round)
    tenant().wait(address_of(&barrier.round), round, forever, IRT_PC);
  return 0;
}

// --- C11: the same objects, other answers ------------------------------------------------------

namespace {

int in_c11(int error) {
  return error == 0 ? thrd_success : error == EBUSY ? thrd_busy : thrd_timedout;
}

}  // namespace

// What only ever succeeds is the same function.
#define IRT_C11(name, posix) \
  asm(".globl irt_vc_" name "\n.set irt_vc_" name ", irt_vc_pthread_" posix)
IRT_C11("mtx_lock", "mutex_lock");
IRT_C11("mtx_unlock", "mutex_unlock");
IRT_C11("mtx_destroy", "mutex_destroy");
IRT_C11("cnd_signal", "cond_signal");
IRT_C11("cnd_broadcast", "cond_broadcast");
IRT_C11("cnd_wait", "cond_wait");
IRT_C11("cnd_destroy", "cond_destroy");
#undef IRT_C11
IRT_REDIRECTED int irt_vc_mtx_init(pthread_mutex_t* m, int kind) {
  clear(*m, IRT_PC);
  if ((kind & mtx_recursive) != 0) mutex_of(m, IRT_PC).kind = PTHREAD_MUTEX_RECURSIVE;
  return thrd_success;
}
IRT_REDIRECTED int irt_vc_mtx_trylock(pthread_mutex_t* m) {
  return in_c11(try_lock(mutex_of(m, IRT_PC), IRT_PC));
}
IRT_REDIRECTED int irt_vc_mtx_timedlock(pthread_mutex_t* m, const timespec* deadline) {
  return in_c11(lock(mutex_of(m, IRT_PC), until(deadline), IRT_PC));
}
IRT_REDIRECTED int irt_vc_cnd_init(pthread_cond_t* c) {
  clear(*c, IRT_PC);
  return thrd_success;
}
IRT_REDIRECTED int irt_vc_cnd_timedwait(pthread_cond_t* c, pthread_mutex_t* m,
                                        const timespec* deadline) {
  return in_c11(condition_wait(c, mutex_of(m, IRT_PC), until(deadline), IRT_PC));
}

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
