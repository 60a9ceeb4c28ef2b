/// What `-fsanitize=thread` compiles accesses to memory into: calls of these functions, whose names
/// and signatures are the compilers' (GCC: sanitizer.def, Clang: ThreadSanitizer.cpp).
///
/// They are written here and nowhere else. Who defines some goes through a list with a macro of its
/// own, so that none is forgotten:
///
///     stress/virtual_cores/hooks.cpp                asks a tenant
///     bench/counted/runtime.cpp                     carries out and counts
///     stress/threads/tsan_atomics.cpp               leads on to ThreadSanitizer's own
///     stress/virtual_cores/symbols/instruction.cpp  knows the calls in machine code
///
/// In the lists a function is named without the `__tsan_` that precedes all of them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace irt::sanitizer {

using Word8 = std::uint8_t;
using Word16 = std::uint16_t;
using Word32 = std::uint32_t;
using Word64 = std::uint64_t;
__extension__ using Word128 = unsigned __int128;

/// The order itself: compilers may add flags above it.
constexpr int order_of(int order) {
  return order & 7;
}

}  // namespace irt::sanitizer

// Names are pasted together here, and parameters have the names that definitions use.
// NOLINTBEGIN(bugprone-macro-parentheses)

/// Plain accesses, `void (void*)`: X(name, read or write, bytes). Aligned or not, volatile or not.
#define IRT_SANITIZER_PLAIN(X)            \
  IRT_SANITIZER_PLAIN_KIND(X, )           \
  IRT_SANITIZER_PLAIN_KIND(X, unaligned_) \
  IRT_SANITIZER_PLAIN_KIND(X, volatile_)  \
  IRT_SANITIZER_PLAIN_KIND(X, unaligned_volatile_)
#define IRT_SANITIZER_PLAIN_KIND(X, kind) \
  IRT_SANITIZER_PLAIN_SIZE(X, kind, 1)    \
  IRT_SANITIZER_PLAIN_SIZE(X, kind, 2)    \
  IRT_SANITIZER_PLAIN_SIZE(X, kind, 4)    \
  IRT_SANITIZER_PLAIN_SIZE(X, kind, 8)    \
  IRT_SANITIZER_PLAIN_SIZE(X, kind, 16)
#define IRT_SANITIZER_PLAIN_SIZE(X, kind, bytes) \
  X(kind##read##bytes, read, bytes)              \
  X(kind##write##bytes, write, bytes)

/// Accesses of other sizes, and what is none; all return nothing: X(name, types of parameters).
#define IRT_SANITIZER_OTHER(X)         \
  X(read_range, (void*, std::size_t))  \
  X(write_range, (void*, std::size_t)) \
  X(vptr_read, (void**))               \
  X(vptr_update, (void**, void*))      \
  X(func_entry, (void*))               \
  X(func_exit, ())                     \
  X(init, ())                          \
  X(acquire, (void*))                  \
  X(release, (void*))

/// `void (int order)`: X(name).
#define IRT_SANITIZER_FENCES(X) \
  X(atomic_thread_fence)        \
  X(atomic_signal_fence)

/// Clang from 16 on calls these instead of the C library's: X(name, the type of the second
/// parameter).
#define IRT_SANITIZER_BLOCKS(X) \
  X(memcpy, const void*)        \
  X(memmove, const void*)       \
  X(memset, int)

/// Atomic operations: LOAD(bits, name) and so on, MODIFY(bits, name, modification) and
/// COMPARE(bits, name, weak). Their signatures are below.
#define IRT_SANITIZER_ATOMICS(LOAD, STORE, MODIFY, COMPARE, COMPARE_VALUE)  \
  IRT_SANITIZER_ATOMICS_OF(8, LOAD, STORE, MODIFY, COMPARE, COMPARE_VALUE)  \
  IRT_SANITIZER_ATOMICS_OF(16, LOAD, STORE, MODIFY, COMPARE, COMPARE_VALUE) \
  IRT_SANITIZER_ATOMICS_OF(32, LOAD, STORE, MODIFY, COMPARE, COMPARE_VALUE) \
  IRT_SANITIZER_ATOMICS_OF(64, LOAD, STORE, MODIFY, COMPARE, COMPARE_VALUE) \
  IRT_SANITIZER_ATOMICS_OF(128, LOAD, STORE, MODIFY, COMPARE, COMPARE_VALUE)
#define IRT_SANITIZER_ATOMICS_OF(bits, LOAD, STORE, MODIFY, COMPARE, COMPARE_VALUE) \
  LOAD(bits, atomic##bits##_load)                                                   \
  STORE(bits, atomic##bits##_store)                                                 \
  MODIFY(bits, atomic##bits##_exchange, exchange)                                   \
  MODIFY(bits, atomic##bits##_fetch_add, fetch_add)                                 \
  MODIFY(bits, atomic##bits##_fetch_sub, fetch_sub)                                 \
  MODIFY(bits, atomic##bits##_fetch_and, fetch_and)                                 \
  MODIFY(bits, atomic##bits##_fetch_or, fetch_or)                                   \
  MODIFY(bits, atomic##bits##_fetch_xor, fetch_xor)                                 \
  MODIFY(bits, atomic##bits##_fetch_nand, fetch_nand)                               \
  COMPARE(bits, atomic##bits##_compare_exchange_strong, false)                      \
  COMPARE(bits, atomic##bits##_compare_exchange_weak, true)                         \
  COMPARE_VALUE(bits, atomic##bits##_compare_exchange_val)

#define IRT_SANITIZER_WORD(bits) irt::sanitizer::Word##bits
#define IRT_SANITIZER_LOAD(bits, name) \
  IRT_SANITIZER_WORD(bits)             \
  name(const volatile IRT_SANITIZER_WORD(bits) * object, [[maybe_unused]] int order)
#define IRT_SANITIZER_STORE(bits, name)                                                   \
  void name(volatile IRT_SANITIZER_WORD(bits) * object, IRT_SANITIZER_WORD(bits) desired, \
            [[maybe_unused]] int order)
#define IRT_SANITIZER_MODIFY(bits, name)                                             \
  IRT_SANITIZER_WORD(bits)                                                           \
  name(volatile IRT_SANITIZER_WORD(bits) * object, IRT_SANITIZER_WORD(bits) operand, \
       [[maybe_unused]] int order)
/// Whether `desired` was stored; if not, `expected` becomes what was seen.
#define IRT_SANITIZER_COMPARE(bits, name)                                                   \
  int name(volatile IRT_SANITIZER_WORD(bits) * object, IRT_SANITIZER_WORD(bits) * expected, \
           IRT_SANITIZER_WORD(bits) desired, [[maybe_unused]] int success,                  \
           [[maybe_unused]] int failure)
/// What was seen.
#define IRT_SANITIZER_COMPARE_VALUE(bits, name)                                       \
  IRT_SANITIZER_WORD(bits)                                                            \
  name(volatile IRT_SANITIZER_WORD(bits) * object, IRT_SANITIZER_WORD(bits) expected, \
       IRT_SANITIZER_WORD(bits) desired, [[maybe_unused]] int success,                \
       [[maybe_unused]] int failure)

// NOLINTEND(bugprone-macro-parentheses)
