// The entry points that `-fsanitize=thread` compiles accesses to memory into. Their names and
// signatures are the compilers' (GCC: sanitizer.def, Clang: ThreadSanitizer.cpp).
//
// Atomic operations come in through a few instructions of assembly that note the callee-saved
// registers as the code had them; a tenant needs these to know a loop that has not moved.

#include "stress/virtual_cores/internal.hpp"

using irt::virtual_cores::Access;
using irt::virtual_cores::active;
using irt::virtual_cores::address_of;
using irt::virtual_cores::announce_read;
using irt::virtual_cores::announce_write;
using irt::virtual_cores::ask;
using irt::virtual_cores::Modification;
using irt::virtual_cores::Order;
using irt::virtual_cores::Registers;
using irt::virtual_cores::Value;

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
__attribute__((visibility("hidden"))) Registers irt_vc_registers;
}

namespace irt::virtual_cores {
Asked asked;

const Registers& registers() {
  return irt_vc_registers;
}
void forget_registers() {
  irt_vc_registers.stack_pointer = 0;
}
}  // namespace irt::virtual_cores

namespace {

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;
using u128 = Value;

// Compilers may add flags above the order itself.
Order order_of(int order) {
  return static_cast<Order>(order & 7);
}

template <class T>
Access access_to(const volatile T* object, int order, const void* pc) {
  ask(object, sizeof(T), pc);
  return {address_of(object), sizeof(T), order_of(order), pc};
}

// Whether `object` is in a frame of the caller: there it is a register that the hook's signature
// has put on the stack, and no access of the code.
bool is_local(const volatile void* object) {
  constexpr std::uintptr_t frames = 4096;
  return address_of(object) - reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0)) < frames;
}

}  // namespace

#define IRT_PC __builtin_return_address(0)
#define IRT_HOOK extern "C" __attribute__((visibility("default"))) void
#define IRT_BODY extern "C" __attribute__((visibility("hidden"), used))

// Plain accesses of every size, aligned or not, volatile or not.
#define IRT_PLAIN(prefix, size)                    \
  IRT_HOOK __tsan_##prefix##read##size(void* p) {  \
    announce_read(p, size, IRT_PC);                \
  }                                                \
  IRT_HOOK __tsan_##prefix##write##size(void* p) { \
    announce_write(p, size, IRT_PC);               \
  }
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

IRT_HOOK __tsan_read_range(void* p, std::size_t size) {
  announce_read(p, size, IRT_PC);
}
IRT_HOOK __tsan_write_range(void* p, std::size_t size) {
  announce_write(p, size, IRT_PC);
}
IRT_HOOK __tsan_vptr_read(void** p) {
  announce_read(p, sizeof *p, IRT_PC);
}
IRT_HOOK __tsan_vptr_update(void** p, void* value) {
  // Constructors and destructors of bases rewrite the same pointer; only a change is a write.
  if (*p != value) announce_write(p, sizeof *p, IRT_PC);
}
// Clang from 16 on calls these instead of the C library's functions.
extern "C" void* irt_vc_memcpy(void* to, const void* from, std::size_t size);
extern "C" void* irt_vc_memmove(void* to, const void* from, std::size_t size);
extern "C" void* irt_vc_memset(void* to, int byte, std::size_t size);
asm(".globl __tsan_memcpy, __tsan_memmove, __tsan_memset\n"
    ".set __tsan_memcpy, irt_vc_memcpy\n.set __tsan_memmove, irt_vc_memmove\n"
    ".set __tsan_memset, irt_vc_memset");
IRT_HOOK __tsan_func_entry(void* call_site) {
  active->enter_function(call_site);
}
IRT_HOOK __tsan_func_exit() {
  active->leave_function();
}
IRT_HOOK __tsan_init() {}
IRT_HOOK __tsan_acquire(void*) {}
IRT_HOOK __tsan_release(void*) {}
IRT_HOOK __tsan_atomic_thread_fence(int order) {
  active->fence(order_of(order), IRT_PC);
}
IRT_HOOK __tsan_atomic_signal_fence(int) {}

// The way in: notes the registers, then goes on to irt_vc_NAME with the arguments untouched.
#define IRT_ENTRY(name)                                                              \
  asm(".pushsection .text\n.globl __tsan_" #name "\n.type __tsan_" #name             \
      ", @function\n__tsan_" #name                                                   \
      ":\n"                                                                          \
      "movq %rbx, irt_vc_registers(%rip)\nmovq %rbp, irt_vc_registers+8(%rip)\n"     \
      "movq %r12, irt_vc_registers+16(%rip)\nmovq %r13, irt_vc_registers+24(%rip)\n" \
      "movq %r14, irt_vc_registers+32(%rip)\nmovq %r15, irt_vc_registers+40(%rip)\n" \
      "movq %rsp, irt_vc_registers+48(%rip)\njmp irt_vc_" #name "\n.popsection");

#define IRT_MODIFY(bits, name, operation)                                                          \
  IRT_BODY u##bits irt_vc_atomic##bits##_##name(volatile u##bits* p, u##bits operand, int order) { \
    return static_cast<u##bits>(                                                                   \
        active->modify(access_to(p, order, IRT_PC), Modification::operation, operand));            \
  }                                                                                                \
  IRT_ENTRY(atomic##bits##_##name)

#define IRT_COMPARE_EXCHANGE(bits, name, weak)                                                 \
  IRT_BODY int irt_vc_atomic##bits##_compare_exchange_##name(                                  \
      volatile u##bits* p, u##bits* expected, u##bits desired, int success, int failure) {     \
    const bool shared = !is_local(expected);                                                   \
    if (shared) announce_read(expected, sizeof *expected, IRT_PC);                             \
    Value seen = *expected;                                                                    \
    if (active->compare_exchange(access_to(p, success, IRT_PC), order_of(failure), weak, seen, \
                                 desired))                                                     \
      return 1;                                                                                \
    if (shared) announce_write(expected, sizeof *expected, IRT_PC);                            \
    *expected = static_cast<u##bits>(seen);                                                    \
    return 0;                                                                                  \
  }                                                                                            \
  IRT_ENTRY(atomic##bits##_compare_exchange_##name)

#define IRT_ATOMIC(bits)                                                                     \
  IRT_BODY u##bits irt_vc_atomic##bits##_load(const volatile u##bits* p, int order) {        \
    return static_cast<u##bits>(active->load(access_to(p, order, IRT_PC)));                  \
  }                                                                                          \
  IRT_ENTRY(atomic##bits##_load)                                                             \
  IRT_BODY void irt_vc_atomic##bits##_store(volatile u##bits* p, u##bits value, int order) { \
    active->store(access_to(p, order, IRT_PC), value);                                       \
  }                                                                                          \
  IRT_ENTRY(atomic##bits##_store)                                                            \
  IRT_MODIFY(bits, exchange, exchange)                                                       \
  IRT_MODIFY(bits, fetch_add, add)                                                           \
  IRT_MODIFY(bits, fetch_sub, sub)                                                           \
  IRT_MODIFY(bits, fetch_and, bit_and)                                                       \
  IRT_MODIFY(bits, fetch_or, bit_or)                                                         \
  IRT_MODIFY(bits, fetch_xor, bit_xor)                                                       \
  IRT_MODIFY(bits, fetch_nand, bit_nand)                                                     \
  IRT_COMPARE_EXCHANGE(bits, strong, false)                                                  \
  IRT_COMPARE_EXCHANGE(bits, weak, true)                                                     \
  IRT_BODY u##bits irt_vc_atomic##bits##_compare_exchange_val(                               \
      volatile u##bits* p, u##bits expected, u##bits desired, int success, int failure) {    \
    Value seen = expected;                                                                   \
    active->compare_exchange(access_to(p, success, IRT_PC), order_of(failure), false, seen,  \
                             desired);                                                       \
    return static_cast<u##bits>(seen);                                                       \
  }                                                                                          \
  IRT_ENTRY(atomic##bits##_compare_exchange_val)

IRT_ATOMIC(8)
IRT_ATOMIC(16)
IRT_ATOMIC(32)
IRT_ATOMIC(64)
IRT_ATOMIC(128)
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
