// The entry points that `-fsanitize=thread` compiles accesses to memory into (sanitizer_abi.hpp).
//
// Atomic operations come in through a few instructions of assembly that note the callee-saved
// registers as the code had them; a tenant needs these to know a loop that has not moved.

#include <type_traits>

#include "stress/virtual_cores/internal.hpp"
#include "stress/virtual_cores/sanitizer_abi.hpp"

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

Order order_of(int order) {
  return static_cast<Order>(irt::sanitizer::order_of(order));
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

#define IRT_HOOK extern "C" __attribute__((visibility("default"))) void
#define IRT_BODY extern "C" __attribute__((visibility("hidden"), used))

#define IRT_PLAIN(name, kind, bytes)        \
  IRT_HOOK __tsan_##name(void* object) {    \
    announce_##kind(object, bytes, IRT_PC); \
  }
IRT_SANITIZER_PLAIN(IRT_PLAIN)

IRT_HOOK __tsan_read_range(void* object, std::size_t bytes) {
  announce_read(object, bytes, IRT_PC);
}
IRT_HOOK __tsan_write_range(void* object, std::size_t bytes) {
  announce_write(object, bytes, IRT_PC);
}
IRT_HOOK __tsan_vptr_read(void** object) {
  announce_read(object, sizeof *object, IRT_PC);
}
IRT_HOOK __tsan_vptr_update(void** object, void* value) {
  // Constructors and destructors of bases rewrite the same pointer; only a change is a write.
  if (*object != value) announce_write(object, sizeof *object, IRT_PC);
}
IRT_HOOK __tsan_func_entry(void* call_site) {
  active->enter_function(call_site);
}
IRT_HOOK __tsan_func_exit() {
  // The frame pointer of the function that returns is where this one's points to; above it is the
  // address that it returns to.
  constexpr std::uintptr_t pointer_and_return = 16;
  const auto* const frame = static_cast<const std::uintptr_t*>(__builtin_frame_address(0));
  active->leave_function(*frame + pointer_and_return, IRT_PC);
}
IRT_HOOK __tsan_init() {}
IRT_HOOK __tsan_acquire(void*) {}
IRT_HOOK __tsan_release(void*) {}
IRT_HOOK __tsan_atomic_thread_fence(int order) {
  active->fence(order_of(order), IRT_PC);
}
IRT_HOOK __tsan_atomic_signal_fence(int) {}

// None is missing, and none has another signature.
#define IRT_DEFINED(name, ...) \
  static_assert(std::is_same_v<decltype(__tsan_##name), void __VA_ARGS__>);
#define IRT_FENCE_DEFINED(name) IRT_DEFINED(name, (int))
IRT_SANITIZER_OTHER(IRT_DEFINED)
IRT_SANITIZER_FENCES(IRT_FENCE_DEFINED)

#define IRT_BLOCK(name, second)                               \
  extern "C" void* irt_vc_##name(void*, second, std::size_t); \
  asm(".globl __tsan_" #name "\n.set __tsan_" #name ", irt_vc_" #name);
IRT_SANITIZER_BLOCKS(IRT_BLOCK)

// The way in: notes the registers, then goes on to irt_vc_NAME with the arguments untouched.
#define IRT_ENTRY(name)                                                              \
  asm(".pushsection .text\n.globl __tsan_" #name "\n.type __tsan_" #name             \
      ", @function\n__tsan_" #name                                                   \
      ":\n"                                                                          \
      "movq %rbx, irt_vc_registers(%rip)\nmovq %rbp, irt_vc_registers+8(%rip)\n"     \
      "movq %r12, irt_vc_registers+16(%rip)\nmovq %r13, irt_vc_registers+24(%rip)\n" \
      "movq %r14, irt_vc_registers+32(%rip)\nmovq %r15, irt_vc_registers+40(%rip)\n" \
      "movq %rsp, irt_vc_registers+48(%rip)\njmp irt_vc_" #name "\n.popsection");

#define IRT_LOAD(bits, name)                                                                      \
  IRT_ENTRY(name)                                                                                 \
  IRT_BODY IRT_SANITIZER_LOAD(bits, irt_vc_##name) {                                              \
    return static_cast<IRT_SANITIZER_WORD(bits)>(active->load(access_to(object, order, IRT_PC))); \
  }
#define IRT_STORE(bits, name)                                 \
  IRT_ENTRY(name)                                             \
  IRT_BODY IRT_SANITIZER_STORE(bits, irt_vc_##name) {         \
    active->store(access_to(object, order, IRT_PC), desired); \
  }
#define IRT_MODIFY(bits, name, modification)                                                    \
  IRT_ENTRY(name)                                                                               \
  IRT_BODY IRT_SANITIZER_MODIFY(bits, irt_vc_##name) {                                          \
    return static_cast<IRT_SANITIZER_WORD(bits)>(                                               \
        active->modify(access_to(object, order, IRT_PC), Modification::modification, operand)); \
  }
#define IRT_COMPARE(bits, name, weak)                                                         \
  IRT_ENTRY(name)                                                                             \
  IRT_BODY IRT_SANITIZER_COMPARE(bits, irt_vc_##name) {                                       \
    const bool shared = !is_local(expected);                                                  \
    if (shared) announce_read(expected, sizeof *expected, IRT_PC);                            \
    Value seen = *expected;                                                                   \
    if (active->compare_exchange(access_to(object, success, IRT_PC), order_of(failure), weak, \
                                 seen, desired))                                              \
      return 1;                                                                               \
    if (shared) announce_write(expected, sizeof *expected, IRT_PC);                           \
    *expected = static_cast<IRT_SANITIZER_WORD(bits)>(seen);                                  \
    return 0;                                                                                 \
  }
#define IRT_COMPARE_VALUE(bits, name)                                                            \
  IRT_ENTRY(name)                                                                                \
  IRT_BODY IRT_SANITIZER_COMPARE_VALUE(bits, irt_vc_##name) {                                    \
    Value seen = expected;                                                                       \
    active->compare_exchange(access_to(object, success, IRT_PC), order_of(failure), false, seen, \
                             desired);                                                           \
    return static_cast<IRT_SANITIZER_WORD(bits)>(seen);                                          \
  }
IRT_SANITIZER_ATOMICS(IRT_LOAD, IRT_STORE, IRT_MODIFY, IRT_COMPARE, IRT_COMPARE_VALUE)
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
