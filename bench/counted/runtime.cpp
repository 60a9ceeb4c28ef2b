// The entry points that -fsanitize=thread compiles accesses into: atomic operations are carried out
// for real and counted for the thread. Plain accesses are let through: their hooks do nothing.
//
// Read-modify-writes are sequentially consistent whatever was asked for; on x86-64 they are so
// anyway. Loads and stores have the order asked for, or the next stronger one.

#include <atomic>
#include <cstddef>
#include <cstring>
#include <utility>

#include "bench/counted/atomic_events.hpp"
#include "stress/virtual_cores/modification.hpp"
#include "stress/virtual_cores/sanitizer_abi.hpp"

namespace {

using irt::virtual_cores::Modification;

struct alignas(128) Counts {
  irt::AtomicEvents events;
};

thread_local constinit Counts counts;

constexpr int seq_cst = __ATOMIC_SEQ_CST;

bool is_seq_cst(int order) {
  return irt::sanitizer::order_of(order) == seq_cst;
}

/// Of 16 bytes the processor has the compare-and-swap alone.
template <class Word>
constexpr bool is_wide = sizeof(Word) == 16;

/// Whether it was done; if not, `expected` becomes what was seen.
template <class Word>
bool compare_and_swap(volatile Word* object, Word& expected, Word desired) {
  if constexpr (is_wide<Word>) {
    const Word seen = __sync_val_compare_and_swap(object, expected, desired);
    return std::exchange(expected, seen) == seen;
  } else {
    return __atomic_compare_exchange_n(object, &expected, desired, false, seq_cst, seq_cst);
  }
}

template <class Word>
Word load(const volatile Word* object, int order) {
  if constexpr (is_wide<Word>) {
    Word seen = 0;
    compare_and_swap(const_cast<volatile Word*>(object), seen, seen);  // NOLINT: changes nothing
    return seen;
  } else {
    return is_seq_cst(order) ? __atomic_load_n(object, seq_cst)
                             : __atomic_load_n(object, __ATOMIC_ACQUIRE);
  }
}

template <Modification modification, class Word>
Word modify(volatile Word* object, Word operand) {
  if constexpr (is_wide<Word>) {
    Word seen = *object;  // a guess that the loop confirms
    while (!compare_and_swap(object, seen,
                             irt::virtual_cores::apply(modification, seen, operand, sizeof seen))) {
    }
    return seen;
  } else {
    switch (modification) {
      case Modification::exchange:
        return __atomic_exchange_n(object, operand, seq_cst);
      case Modification::fetch_add:
        return __atomic_fetch_add(object, operand, seq_cst);
      case Modification::fetch_sub:
        return __atomic_fetch_sub(object, operand, seq_cst);
      case Modification::fetch_and:
        return __atomic_fetch_and(object, operand, seq_cst);
      case Modification::fetch_or:
        return __atomic_fetch_or(object, operand, seq_cst);
      case Modification::fetch_xor:
        return __atomic_fetch_xor(object, operand, seq_cst);
      case Modification::fetch_nand:
        return __atomic_fetch_nand(object, operand, seq_cst);
    }
  }
}

template <class Word>
void store(volatile Word* object, Word desired, int order) {
  if constexpr (is_wide<Word>)
    modify<Modification::exchange>(object, desired);
  else if (is_seq_cst(order))
    __atomic_store_n(object, desired, seq_cst);
  else
    __atomic_store_n(object, desired, __ATOMIC_RELEASE);
}

template <class Word>
bool compare_exchange(volatile Word* object, Word& expected, Word desired) {
  const bool done = compare_and_swap(object, expected, desired);
  ++counts.events.compare_exchanges;
  if (!done) ++counts.events.failed_compare_exchanges;
  return done;
}

}  // namespace

namespace irt {
__attribute__((visibility("default"))) AtomicEvents& atomic_events() {
  return counts.events;
}
}  // namespace irt

// NOLINTBEGIN(bugprone-reserved-identifier,bugprone-macro-parentheses,readability-identifier-naming)
#define IRT_HOOK extern "C" __attribute__((visibility("default")))

#define IRT_PLAIN(name, kind, bytes) \
  IRT_HOOK void __tsan_##name(void*) {}
IRT_SANITIZER_PLAIN(IRT_PLAIN)
#define IRT_OTHER(name, parameters) \
  IRT_HOOK void __tsan_##name parameters {}
IRT_SANITIZER_OTHER(IRT_OTHER)
#define IRT_FENCE(name)                   \
  IRT_HOOK void __tsan_##name(int) {      \
    std::name(std::memory_order_seq_cst); \
  }
IRT_SANITIZER_FENCES(IRT_FENCE)
#define IRT_BLOCK(name, Second)                                              \
  IRT_HOOK void* __tsan_##name(void* to, Second second, std::size_t bytes) { \
    return std::name(to, second, bytes);                                     \
  }
IRT_SANITIZER_BLOCKS(IRT_BLOCK)

#define IRT_LOAD(bits, name)                         \
  IRT_HOOK IRT_SANITIZER_LOAD(bits, __tsan_##name) { \
    ++counts.events.loads;                           \
    return load(object, order);                      \
  }
#define IRT_STORE(bits, name)                         \
  IRT_HOOK IRT_SANITIZER_STORE(bits, __tsan_##name) { \
    ++counts.events.stores;                           \
    store(object, desired, order);                    \
  }
#define IRT_MODIFY(bits, name, modification)                    \
  IRT_HOOK IRT_SANITIZER_MODIFY(bits, __tsan_##name) {          \
    ++counts.events.other_modifications;                        \
    return modify<Modification::modification>(object, operand); \
  }
#define IRT_COMPARE(bits, name, weak)                            \
  IRT_HOOK IRT_SANITIZER_COMPARE(bits, __tsan_##name) {          \
    return compare_exchange(object, *expected, desired) ? 1 : 0; \
  }
#define IRT_COMPARE_VALUE(bits, name)                         \
  IRT_HOOK IRT_SANITIZER_COMPARE_VALUE(bits, __tsan_##name) { \
    compare_exchange(object, expected, desired);              \
    return expected;                                          \
  }
IRT_SANITIZER_ATOMICS(IRT_LOAD, IRT_STORE, IRT_MODIFY, IRT_COMPARE, IRT_COMPARE_VALUE)
// NOLINTEND(bugprone-reserved-identifier,bugprone-macro-parentheses,readability-identifier-naming)

#if defined(__x86_64__)
// What some instructions have become in these objects (stress/virtual_cores/prelude.hpp).
asm(".pushsection .text\n.globl irt_vc_cpu_pause\n.type irt_vc_cpu_pause, @function\n"
    "irt_vc_cpu_pause:\npause\nret\n"
    ".globl irt_vc_cpu_clock\n.type irt_vc_cpu_clock, @function\n"
    "irt_vc_cpu_clock:\nrdtscp\nret\n"
    ".globl irt_vc_cpu_random\n.type irt_vc_cpu_random, @function\n"
    "irt_vc_cpu_random:\npushq %rax\nrdrand %rax\nmovq %rax, 16(%rsp)\npopq %rax\nret\n"
    ".popsection");
#endif
