// The atomic operations of code that ThreadSanitizer instruments come by here, a plug-in's too:
// this program's definitions precede the library's. For two reasons.
//
// ThreadSanitizer does not understand fences, so it reports races where a fence and a relaxed
// access order two threads. Every order that a fence can give goes through an atomic store and a
// load of it; with all atomics taken as acquire and release, every such order is visible. A race
// that is reported all the same is none of a fence's making. What this hides: races that a fence or
// an order too weak leaves open. Those are for a memory model to find.
//
// The library of GCC makes operations of 16 bytes under a lock of its own, so that for code which
// changes one half with an operation of 8 bytes they are not atomic, and elements get lost. Here
// they are the processor's.
#include <cstdint>
#include <dlfcn.h>
#include <sys/mman.h>

#include "stress/threads/sanitizer.hpp"
#include "stress/virtual_cores/modification.hpp"
#include "stress/virtual_cores/sanitizer_abi.hpp"

namespace {
/// In memory that parent and children share: a child that ThreadSanitizer ends can say no more.
std::uint64_t* const fences = [] {
  void* page = mmap(nullptr, sizeof(std::uint64_t), PROT_READ | PROT_WRITE,
                    MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  static std::uint64_t own = 0;
  return page == MAP_FAILED ? &own : static_cast<std::uint64_t*>(page);
}();
}  // namespace

std::uint64_t irt::stress::fences_executed() {
  return __atomic_load_n(fences, __ATOMIC_RELAXED);
}
void irt::stress::forget_fences() {
  __atomic_store_n(fences, 0, __ATOMIC_RELAXED);
}

#if !defined(__SANITIZE_THREAD__)

void irt::stress::strengthen_atomics() {}

#else

namespace {
bool strong = false;  // set before threads exist

enum Order : int { relaxed = 0, acquire = 2, release = 3, acq_rel = 4, seq_cst = 5 };  // the ABI's

int stronger(int order, int least) {
  return strong && irt::sanitizer::order_of(order) != seq_cst ? least : order;
}
}  // namespace

void irt::stress::strengthen_atomics() {
  strong = true;
}

// NOLINTBEGIN(bugprone-reserved-identifier, bugprone-macro-parentheses,
// readability-identifier-naming)

// As tail calls, so that a report names who made the access.
#define IRT_UNWATCHED __attribute__((no_sanitize("thread"), optimize("optimize-sibling-calls")))

/// The names are builtins to the compiler, hence the others.
#define IRT_FUNCTION(SIGNATURE, bits, name)                         \
  extern "C" SIGNATURE(bits, irt_tsan_##name) asm("__tsan_" #name); \
  IRT_UNWATCHED SIGNATURE(bits, irt_tsan_##name)

/// The library's own function `name`, as `real`.
#define IRT_REAL(name)                                                          \
  static decltype(&irt_tsan_##name) found = nullptr;                            \
  auto real = __atomic_load_n(&found, __ATOMIC_RELAXED);                        \
  if (real == nullptr) {                                                        \
    real = reinterpret_cast<decltype(real)>(dlsym(RTLD_NEXT, "__tsan_" #name)); \
    __atomic_store_n(&found, real, __ATOMIC_RELAXED);                           \
  }

#define IRT_LOAD(bits, name)                       \
  IRT_FUNCTION(IRT_SANITIZER_LOAD, bits, name) {   \
    IRT_REAL(name)                                 \
    return real(object, stronger(order, acquire)); \
  }
#define IRT_STORE(bits, name)                        \
  IRT_FUNCTION(IRT_SANITIZER_STORE, bits, name) {    \
    IRT_REAL(name)                                   \
    real(object, desired, stronger(order, release)); \
  }
#define IRT_MODIFY(bits, name, modification)                \
  IRT_FUNCTION(IRT_SANITIZER_MODIFY, bits, name) {          \
    IRT_REAL(name)                                          \
    return real(object, operand, stronger(order, acq_rel)); \
  }
#define IRT_COMPARE(bits, name, weak)                                  \
  IRT_FUNCTION(IRT_SANITIZER_COMPARE, bits, name) {                    \
    IRT_REAL(name)                                                     \
    return real(object, expected, desired, stronger(success, acq_rel), \
                stronger(failure, acquire));                           \
  }
#define IRT_COMPARE_VALUE(bits, name)                                  \
  IRT_FUNCTION(IRT_SANITIZER_COMPARE_VALUE, bits, name) {              \
    IRT_REAL(name)                                                     \
    return real(object, expected, desired, stronger(success, acq_rel), \
                stronger(failure, acquire));                           \
  }
IRT_SANITIZER_ATOMICS_OF(8, IRT_LOAD, IRT_STORE, IRT_MODIFY, IRT_COMPARE, IRT_COMPARE_VALUE)
IRT_SANITIZER_ATOMICS_OF(16, IRT_LOAD, IRT_STORE, IRT_MODIFY, IRT_COMPARE, IRT_COMPARE_VALUE)
IRT_SANITIZER_ATOMICS_OF(32, IRT_LOAD, IRT_STORE, IRT_MODIFY, IRT_COMPARE, IRT_COMPARE_VALUE)
IRT_SANITIZER_ATOMICS_OF(64, IRT_LOAD, IRT_STORE, IRT_MODIFY, IRT_COMPARE, IRT_COMPARE_VALUE)

// The counter is touched without instrumentation, so that it orders nothing in TSan's eyes.
extern "C" void irt_tsan_atomic_thread_fence(int order) asm("__tsan_atomic_thread_fence");
IRT_UNWATCHED void irt_tsan_atomic_thread_fence(int order) {
  IRT_REAL(atomic_thread_fence)
  if (fences != nullptr) __atomic_fetch_add(fences, 1, __ATOMIC_RELAXED);
  real(order);
}

#if defined(__x86_64__)

extern "C" void __tsan_acquire(void* at);
extern "C" void __tsan_release(void* at);

namespace {
using Wide = irt::sanitizer::Word128;
using Half = irt::sanitizer::Word64;
using irt::virtual_cores::Modification;

/// Whether `at` was `*expected` and is `value` now; if not, `*expected` is what it was. Always
/// acquires and releases. Nothing here is a tail call, so a report has a frame more.
IRT_UNWATCHED bool swap(volatile Wide* at, Wide* expected, Wide value, bool writes) {
  auto* halves = reinterpret_cast<volatile Half*>(const_cast<Wide*>(at));
  const auto each_half = [&](auto what) IRT_UNWATCHED {
    what(halves);
    what(halves + 1);
  };
  const auto acquires = [](volatile Half* half)
                            IRT_UNWATCHED { __tsan_acquire(const_cast<Half*>(half)); };
  each_half(acquires);
  // So that a plain access of another thread is a race.
  each_half([&](volatile Half* half) IRT_UNWATCHED {
    if (writes)
      irt_tsan_atomic64_fetch_add(half, 0, relaxed);
    else
      irt_tsan_atomic64_load(half, relaxed);
  });
  each_half([](volatile Half* half) IRT_UNWATCHED { __tsan_release(const_cast<Half*>(half)); });
  auto low = static_cast<Half>(*expected);
  auto high = static_cast<Half>(*expected >> 64);
  bool swapped = false;
  asm volatile("lock cmpxchg16b %1"
               : "=@ccz"(swapped), "+m"(*at), "+a"(low), "+d"(high)
               : "b"(static_cast<Half>(value)), "c"(static_cast<Half>(value >> 64))
               : "memory");
  each_half(acquires);
  if (!swapped) *expected = static_cast<Wide>(high) << 64 | low;
  return swapped;
}

IRT_UNWATCHED Wide change(volatile Wide* at, Modification modification, Wide operand) {
  Wide seen = 0;
  while (
      !swap(at, &seen, irt::virtual_cores::apply(modification, seen, operand, sizeof seen), true)) {
  }
  return seen;
}
}  // namespace

#define IRT_WIDE_LOAD(bits, name)                              \
  IRT_FUNCTION(IRT_SANITIZER_LOAD, bits, name) {               \
    Wide seen = 0;                                             \
    swap(const_cast<volatile Wide*>(object), &seen, 0, false); \
    return seen;                                               \
  }
#define IRT_WIDE_STORE(bits, name)                   \
  IRT_FUNCTION(IRT_SANITIZER_STORE, bits, name) {    \
    change(object, Modification::exchange, desired); \
  }
#define IRT_WIDE_MODIFY(bits, name, modification)               \
  IRT_FUNCTION(IRT_SANITIZER_MODIFY, bits, name) {              \
    return change(object, Modification::modification, operand); \
  }
#define IRT_WIDE_COMPARE(bits, name, weak)                \
  IRT_FUNCTION(IRT_SANITIZER_COMPARE, bits, name) {       \
    return swap(object, expected, desired, true) ? 1 : 0; \
  }
#define IRT_WIDE_COMPARE_VALUE(bits, name)                \
  IRT_FUNCTION(IRT_SANITIZER_COMPARE_VALUE, bits, name) { \
    swap(object, &expected, desired, true);               \
    return expected;                                      \
  }
IRT_SANITIZER_ATOMICS_OF(128, IRT_WIDE_LOAD, IRT_WIDE_STORE, IRT_WIDE_MODIFY, IRT_WIDE_COMPARE,
                         IRT_WIDE_COMPARE_VALUE)

#endif
// NOLINTEND(bugprone-reserved-identifier, bugprone-macro-parentheses,
// readability-identifier-naming)

#endif
