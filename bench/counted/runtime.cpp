// The entry points that -fsanitize=thread compiles atomic operations into, carried out for real and
// counted for the thread. Their names and signatures are the compilers' (GCC: sanitizer.def, Clang:
// ThreadSanitizer.cpp). Plain accesses are let through: their hooks do nothing.
//
// Read-modify-writes are sequentially consistent whatever was asked for; on x86-64 they are so
// anyway. Loads and stores have the order asked for, or the next stronger one.

#include <atomic>
#include <cstddef>

#include "bench/counted/atomic_events.hpp"

namespace {

struct alignas(128) Counts {
  irt::AtomicEvents events;
};

thread_local constinit Counts counts;

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;

constexpr int seq_cst = __ATOMIC_SEQ_CST;

/// Compilers may add flags above the order itself.
bool is_seq_cst(int order) {
  return (order & 7) == seq_cst;
}

}  // namespace

namespace irt {
__attribute__((visibility("default"))) AtomicEvents& atomic_events() {
  return counts.events;
}
}  // namespace irt

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
#define IRT_HOOK extern "C" __attribute__((visibility("default")))

#define IRT_PLAIN(prefix, size)                       \
  IRT_HOOK void __tsan_##prefix##read##size(void*) {} \
  IRT_HOOK void __tsan_##prefix##write##size(void*) {}
#define IRT_PLAIN_ALL(prefix) \
  IRT_PLAIN(prefix, 1)        \
  IRT_PLAIN(prefix, 2)        \
  IRT_PLAIN(prefix, 4)        \
  IRT_PLAIN(prefix, 8)        \
  IRT_PLAIN(prefix, 16)
IRT_PLAIN_ALL()
IRT_PLAIN_ALL(unaligned_)
IRT_PLAIN_ALL(volatile_)
IRT_PLAIN_ALL(unaligned_volatile_)

IRT_HOOK void __tsan_read_range(void*, std::size_t) {}
IRT_HOOK void __tsan_write_range(void*, std::size_t) {}
IRT_HOOK void __tsan_vptr_read(void**) {}
IRT_HOOK void __tsan_vptr_update(void**, void*) {}
IRT_HOOK void __tsan_func_entry(void*) {}
IRT_HOOK void __tsan_func_exit() {}
IRT_HOOK void __tsan_init() {}
IRT_HOOK void __tsan_acquire(void*) {}
IRT_HOOK void __tsan_release(void*) {}
IRT_HOOK void __tsan_atomic_thread_fence(int) {
  std::atomic_thread_fence(std::memory_order_seq_cst);
}
IRT_HOOK void __tsan_atomic_signal_fence(int) {
  std::atomic_signal_fence(std::memory_order_seq_cst);
}

#define IRT_MODIFY(bits, name, builtin)                                                    \
  IRT_HOOK u##bits __tsan_atomic##bits##_##name(volatile u##bits* p, u##bits value, int) { \
    ++counts.events.other_modifications;                                                   \
    return builtin(p, value, seq_cst);                                                     \
  }

#define IRT_COMPARE_EXCHANGE(bits, name)                                                          \
  IRT_HOOK int __tsan_atomic##bits##_compare_exchange_##name(                                     \
      volatile u##bits* p, u##bits* expected, u##bits desired, int, int) {                        \
    const bool done = __atomic_compare_exchange_n(p, expected, desired, false, seq_cst, seq_cst); \
    ++counts.events.compare_exchanges;                                                            \
    if (!done) ++counts.events.failed_compare_exchanges;                                          \
    return done ? 1 : 0;                                                                          \
  }

#define IRT_ATOMIC(bits)                                                                           \
  IRT_HOOK u##bits __tsan_atomic##bits##_load(const volatile u##bits* p, int order) {              \
    ++counts.events.loads;                                                                         \
    return is_seq_cst(order) ? __atomic_load_n(p, seq_cst) : __atomic_load_n(p, __ATOMIC_ACQUIRE); \
  }                                                                                                \
  IRT_HOOK void __tsan_atomic##bits##_store(volatile u##bits* p, u##bits value, int order) {       \
    ++counts.events.stores;                                                                        \
    if (is_seq_cst(order))                                                                         \
      __atomic_store_n(p, value, seq_cst);                                                         \
    else                                                                                           \
      __atomic_store_n(p, value, __ATOMIC_RELEASE);                                                \
  }                                                                                                \
  IRT_MODIFY(bits, exchange, __atomic_exchange_n)                                                  \
  IRT_MODIFY(bits, fetch_add, __atomic_fetch_add)                                                  \
  IRT_MODIFY(bits, fetch_sub, __atomic_fetch_sub)                                                  \
  IRT_MODIFY(bits, fetch_and, __atomic_fetch_and)                                                  \
  IRT_MODIFY(bits, fetch_or, __atomic_fetch_or)                                                    \
  IRT_MODIFY(bits, fetch_xor, __atomic_fetch_xor)                                                  \
  IRT_MODIFY(bits, fetch_nand, __atomic_fetch_nand)                                                \
  IRT_COMPARE_EXCHANGE(bits, strong)                                                               \
  IRT_COMPARE_EXCHANGE(bits, weak)                                                                 \
  IRT_HOOK u##bits __tsan_atomic##bits##_compare_exchange_val(                                     \
      volatile u##bits* p, u##bits expected, u##bits desired, int, int) {                          \
    __tsan_atomic##bits##_compare_exchange_strong(p, &expected, desired, seq_cst, seq_cst);        \
    return expected;                                                                               \
  }

IRT_ATOMIC(8)
IRT_ATOMIC(16)
IRT_ATOMIC(32)
IRT_ATOMIC(64)

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

// 16 bytes: what the processor has is the compare-and-swap alone.
__extension__ using u128 = unsigned __int128;

namespace {
u128 compare_and_swap(volatile u128* p, u128 expected, u128 desired) {
  return __sync_val_compare_and_swap(p, expected, desired);
}
}  // namespace

IRT_HOOK int __tsan_atomic128_compare_exchange_strong(volatile u128* p, u128* expected,
                                                      u128 desired, int, int) {
  const u128 seen = compare_and_swap(p, *expected, desired);
  ++counts.events.compare_exchanges;
  if (seen == *expected) return 1;
  ++counts.events.failed_compare_exchanges;
  *expected = seen;
  return 0;
}
IRT_HOOK int __tsan_atomic128_compare_exchange_weak(volatile u128* p, u128* expected, u128 desired,
                                                    int success, int failure) {
  return __tsan_atomic128_compare_exchange_strong(p, expected, desired, success, failure);
}
IRT_HOOK u128 __tsan_atomic128_compare_exchange_val(volatile u128* p, u128 expected, u128 desired,
                                                    int success, int failure) {
  __tsan_atomic128_compare_exchange_strong(p, &expected, desired, success, failure);
  return expected;
}
IRT_HOOK u128 __tsan_atomic128_load(const volatile u128* p, int) {
  ++counts.events.loads;
  return compare_and_swap(const_cast<volatile u128*>(p), 0, 0);  // NOLINT: never changes a value
}
IRT_HOOK u128 __tsan_atomic128_exchange(volatile u128* p, u128 value, int) {
  ++counts.events.other_modifications;
  u128 seen = *p;  // a guess that the loop confirms
  for (u128 found = 0; (found = compare_and_swap(p, seen, value)) != seen;) seen = found;
  return seen;
}
IRT_HOOK void __tsan_atomic128_store(volatile u128* p, u128 value, int order) {
  __tsan_atomic128_exchange(p, value, order);
  --counts.events.other_modifications;
  ++counts.events.stores;
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
