// ThreadSanitizer does not understand fences, so it reports races where a fence and a relaxed
// access order two threads. Every order that a fence can give goes through an atomic store and a
// load of it; with all atomics taken as acquire and release, every such order is visible. A race
// that is reported all the same is none of a fence's making.
//
// The linker's --wrap leads the atomics of instrumented code through here. What this hides: races
// that a fence or an order too weak leaves open. Those are for a memory model to find.
#include "stress/threads/sanitizer.hpp"

#if defined(__SANITIZE_THREAD__)

namespace {
bool strong = false;  // set before threads exist

enum Order : int { acquire = 2, release = 3, acq_rel = 4, seq_cst = 5 };  // the ABI's numbers
}  // namespace

void irt::stress::strengthen_atomics() {
  strong = true;
}

// As tail calls, so that a report names who made the access.
#if defined(__clang__)
#define IRT_UNWATCHED __attribute__((no_sanitize("thread")))
#else
#define IRT_UNWATCHED __attribute__((no_sanitize("thread"), optimize("optimize-sibling-calls")))
#endif

// NOLINTBEGIN(bugprone-reserved-identifier, bugprone-macro-parentheses,
// readability-identifier-naming)
#define IRT_EXCHANGE(bits, T, op)                                                           \
  T __real___tsan_atomic##bits##_##op(volatile T* at, T value, int order);                  \
  T __wrap___tsan_atomic##bits##_##op(volatile T* at, T value, int order);                  \
  IRT_UNWATCHED T __wrap___tsan_atomic##bits##_##op(volatile T* at, T value, int order) {   \
    return __real___tsan_atomic##bits##_##op(at, value,                                     \
                                             strong && order != seq_cst ? acq_rel : order); \
  }

#define IRT_COMPARE(bits, T, op)                                                                \
  int __real___tsan_atomic##bits##_##op(volatile T* at, T* expected, T value, int order,        \
                                        int failure);                                           \
  int __wrap___tsan_atomic##bits##_##op(volatile T* at, T* expected, T value, int order,        \
                                        int failure);                                           \
  IRT_UNWATCHED int __wrap___tsan_atomic##bits##_##op(volatile T* at, T* expected, T value,     \
                                                      int order, int failure) {                 \
    return __real___tsan_atomic##bits##_##op(at, expected, value,                               \
                                             strong && order != seq_cst ? acq_rel : order,      \
                                             strong && failure != seq_cst ? acquire : failure); \
  }

#define IRT_ATOMICS(bits, T)                                                                    \
  T __real___tsan_atomic##bits##_load(const volatile T* at, int order);                         \
  T __wrap___tsan_atomic##bits##_load(const volatile T* at, int order);                         \
  IRT_UNWATCHED T __wrap___tsan_atomic##bits##_load(const volatile T* at, int order) {          \
    return __real___tsan_atomic##bits##_load(at, strong && order != seq_cst ? acquire : order); \
  }                                                                                             \
  void __real___tsan_atomic##bits##_store(volatile T* at, T value, int order);                  \
  void __wrap___tsan_atomic##bits##_store(volatile T* at, T value, int order);                  \
  IRT_UNWATCHED void __wrap___tsan_atomic##bits##_store(volatile T* at, T value, int order) {   \
    __real___tsan_atomic##bits##_store(at, value, strong&& order != seq_cst ? release : order); \
  }                                                                                             \
  IRT_EXCHANGE(bits, T, exchange)                                                               \
  IRT_EXCHANGE(bits, T, fetch_add)                                                              \
  IRT_EXCHANGE(bits, T, fetch_sub)                                                              \
  IRT_EXCHANGE(bits, T, fetch_and)                                                              \
  IRT_EXCHANGE(bits, T, fetch_or)                                                               \
  IRT_EXCHANGE(bits, T, fetch_xor)                                                              \
  IRT_COMPARE(bits, T, compare_exchange_strong)                                                 \
  IRT_COMPARE(bits, T, compare_exchange_weak)

extern "C" {
IRT_ATOMICS(8, char)
IRT_ATOMICS(16, short)
IRT_ATOMICS(32, int)
IRT_ATOMICS(64, long)
IRT_ATOMICS(128, __int128)
}
// NOLINTEND(bugprone-reserved-identifier, bugprone-macro-parentheses,
// readability-identifier-naming)

#else

void irt::stress::strengthen_atomics() {}

#endif
