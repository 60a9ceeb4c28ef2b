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
  return strong && order != seq_cst ? least : order;
}
}  // namespace

void irt::stress::strengthen_atomics() {
  strong = true;
}

// NOLINTBEGIN(bugprone-reserved-identifier, bugprone-macro-parentheses,
// readability-identifier-naming)

// As tail calls, so that a report names who made the access.
#define IRT_UNWATCHED __attribute__((no_sanitize("thread"), optimize("optimize-sibling-calls")))

/// The library's own function `name`, as `real`.
#define IRT_REAL(name)                                                \
  static decltype(&irt_##name) found = nullptr;                       \
  auto real = __atomic_load_n(&found, __ATOMIC_RELAXED);              \
  if (real == nullptr) {                                              \
    real = reinterpret_cast<decltype(real)>(dlsym(RTLD_NEXT, #name)); \
    __atomic_store_n(&found, real, __ATOMIC_RELAXED);                 \
  }

// The names are builtins to the compiler, hence the others.
#define IRT_DECLARE(result, name, ...)                  \
  extern "C" result irt_##name(__VA_ARGS__) asm(#name); \
  IRT_UNWATCHED result irt_##name(__VA_ARGS__)

#define IRT_EXCHANGE(bits, T, op)                                                  \
  IRT_DECLARE(T, __tsan_atomic##bits##_##op, volatile T* at, T value, int order) { \
    IRT_REAL(__tsan_atomic##bits##_##op)                                           \
    return real(at, value, stronger(order, acq_rel));                              \
  }

#define IRT_COMPARE(bits, T, op)                                                                \
  IRT_DECLARE(int, __tsan_atomic##bits##_##op, volatile T* at, T* expected, T value, int order, \
              int failure) {                                                                    \
    IRT_REAL(__tsan_atomic##bits##_##op)                                                        \
    return real(at, expected, value, stronger(order, acq_rel), stronger(failure, acquire));     \
  }

#define IRT_ATOMICS(bits, T)                                                           \
  IRT_DECLARE(T, __tsan_atomic##bits##_load, const volatile T* at, int order) {        \
    IRT_REAL(__tsan_atomic##bits##_load)                                               \
    return real(at, stronger(order, acquire));                                         \
  }                                                                                    \
  IRT_DECLARE(void, __tsan_atomic##bits##_store, volatile T* at, T value, int order) { \
    IRT_REAL(__tsan_atomic##bits##_store)                                              \
    real(at, value, stronger(order, release));                                         \
  }                                                                                    \
  IRT_EXCHANGE(bits, T, exchange)                                                      \
  IRT_EXCHANGE(bits, T, fetch_add)                                                     \
  IRT_EXCHANGE(bits, T, fetch_sub)                                                     \
  IRT_EXCHANGE(bits, T, fetch_and)                                                     \
  IRT_EXCHANGE(bits, T, fetch_or)                                                      \
  IRT_EXCHANGE(bits, T, fetch_xor)                                                     \
  IRT_COMPARE(bits, T, compare_exchange_strong)                                        \
  IRT_COMPARE(bits, T, compare_exchange_weak)

IRT_ATOMICS(8, char)
IRT_ATOMICS(16, short)
IRT_ATOMICS(32, int)
IRT_ATOMICS(64, long)

// The counter is touched without instrumentation, so that it orders nothing in TSan's eyes.
IRT_DECLARE(void, __tsan_atomic_thread_fence, int order) {
  IRT_REAL(__tsan_atomic_thread_fence)
  if (fences != nullptr) __atomic_fetch_add(fences, 1, __ATOMIC_RELAXED);
  real(order);
}

#if defined(__x86_64__)

extern "C" void __tsan_acquire(void* at);
extern "C" void __tsan_release(void* at);

namespace {
__extension__ using Wide = __int128;

/// Whether `at` was `*expected` and is `value` now; if not, `*expected` is what it was. Always
/// acquires and releases. Nothing here is a tail call, so a report has a frame more.
IRT_UNWATCHED bool swap(volatile Wide* at, Wide* expected, Wide value, bool writes) {
  auto* halves = reinterpret_cast<volatile long*>(const_cast<Wide*>(at));
  const auto each_half = [&](auto what) IRT_UNWATCHED {
    what(halves);
    what(halves + 1);
  };
  const auto acquires = [](volatile long* half)
                            IRT_UNWATCHED { __tsan_acquire(const_cast<long*>(half)); };
  each_half(acquires);
  // So that a plain access of another thread is a race.
  each_half([&](volatile long* half) IRT_UNWATCHED {
    if (writes)
      irt___tsan_atomic64_fetch_add(half, 0, relaxed);
    else
      irt___tsan_atomic64_load(half, relaxed);
  });
  each_half([](volatile long* half) IRT_UNWATCHED { __tsan_release(const_cast<long*>(half)); });
  auto low = static_cast<std::uint64_t>(*expected);
  auto high = static_cast<std::uint64_t>(*expected >> 64);
  bool swapped = false;
  asm volatile("lock cmpxchg16b %1"
               : "=@ccz"(swapped), "+m"(*at), "+a"(low), "+d"(high)
               : "b"(static_cast<std::uint64_t>(value)),
                 "c"(static_cast<std::uint64_t>(value >> 64))
               : "memory");
  each_half(acquires);
  if (!swapped) *expected = static_cast<Wide>(high) << 64 | low;
  return swapped;
}

template <class Operation>
IRT_UNWATCHED Wide change(volatile Wide* at, Operation operation) {
  Wide seen = 0;
  while (!swap(at, &seen, operation(seen), true)) {
  }
  return seen;
}
}  // namespace

#define IRT_WIDE(op, result)                                                                 \
  IRT_DECLARE(Wide, __tsan_atomic128_##op, volatile Wide* at, Wide value, int /*order*/) {   \
    return change(at, [value]([[maybe_unused]] Wide seen) IRT_UNWATCHED { return result; }); \
  }
#define IRT_WIDE_COMPARE(op)                                                             \
  IRT_DECLARE(int, __tsan_atomic128_##op, volatile Wide* at, Wide* expected, Wide value, \
              int /*order*/, int /*failure*/) {                                          \
    return swap(at, expected, value, true) ? 1 : 0;                                      \
  }

IRT_WIDE(exchange, value)
IRT_WIDE(fetch_add, seen + value)
IRT_WIDE(fetch_sub, seen - value)
IRT_WIDE(fetch_and, seen& value)
IRT_WIDE(fetch_or, seen | value)
IRT_WIDE(fetch_xor, seen ^ value)
IRT_WIDE_COMPARE(compare_exchange_strong)
IRT_WIDE_COMPARE(compare_exchange_weak)
IRT_DECLARE(Wide, __tsan_atomic128_load, const volatile Wide* at, int /*order*/) {
  Wide seen = 0;
  swap(const_cast<volatile Wide*>(at), &seen, 0, false);
  return seen;
}
IRT_DECLARE(void, __tsan_atomic128_store, volatile Wide* at, Wide value, int /*order*/) {
  change(at, [value](Wide) IRT_UNWATCHED { return value; });
}

#endif
// NOLINTEND(bugprone-reserved-identifier, bugprone-macro-parentheses,
// readability-identifier-naming)

#endif
