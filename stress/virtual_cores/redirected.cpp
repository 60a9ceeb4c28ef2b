// The C library as instrumented code sees it: each name of redirected.syms, with `irt_vc_` before
// it. Memory goes to the tenant's heap, time and chance are the tenant's. What works on bytes is in
// strings.cpp, what sleeps in blocking.cpp and once.cpp, what is the kernel's in kernel.cpp.

#include <bit>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <new>
#include <sched.h>
#include <semaphore.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include "stress/virtual_cores/internal.hpp"

using irt::virtual_cores::active;
using irt::virtual_cores::announce_read;
using irt::virtual_cores::announce_write;
using irt::virtual_cores::current_core;
using irt::virtual_cores::nanoseconds_of;
using irt::virtual_cores::set_errno;

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)

// --- Memory ---------------------------------------------------------------------------------

namespace {

constexpr std::size_t default_alignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

void* allocate_or_throw(std::size_t size, std::size_t alignment, const void* pc) {
  void* block = active->allocate(size, alignment, pc);
  if (block == nullptr) throw std::bad_alloc();
  return block;
}

void release(void* block, const void* pc) {
  if (block != nullptr) active->release(block, pc);
}

}  // namespace

IRT_REDIRECTED void* irt_vc_malloc(std::size_t size) {
  return active->allocate(size, default_alignment, IRT_PC);
}
IRT_REDIRECTED void irt_vc_free(void* block) {
  release(block, IRT_PC);
}
IRT_REDIRECTED void* irt_vc_calloc(std::size_t count, std::size_t size) {
  void* block = active->allocate(count * size, default_alignment, IRT_PC);
  if (block == nullptr || count * size == 0) return block;
  announce_write(block, count * size, IRT_PC);
  return std::memset(block, 0, count * size);
}
IRT_REDIRECTED void* irt_vc_realloc(void* block, std::size_t size) {
  void* grown = active->allocate(size, default_alignment, IRT_PC);
  if (block == nullptr || grown == nullptr) return grown;
  const std::size_t kept = std::min(size, active->block_size(block));
  announce_read(block, kept, IRT_PC);
  announce_write(grown, kept, IRT_PC);
  std::memcpy(grown, block, kept);
  active->release(block, IRT_PC);
  return grown;
}
// C17 and POSIX refuse an alignment that is no power of two; memalign takes the next one.
IRT_REDIRECTED void* irt_vc_aligned_alloc(std::size_t alignment, std::size_t size) {
  if (std::has_single_bit(alignment)) return active->allocate(size, alignment, IRT_PC);
  set_errno(EINVAL);
  return nullptr;
}
IRT_REDIRECTED void* irt_vc_memalign(std::size_t alignment, std::size_t size) {
  return active->allocate(size, std::bit_ceil(alignment), IRT_PC);
}
IRT_REDIRECTED int irt_vc_posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  if (!std::has_single_bit(alignment) || alignment % sizeof(void*) != 0) return EINVAL;
  void* const block = active->allocate(size, alignment, IRT_PC);
  if (block == nullptr) return ENOMEM;
  announce_write(result, sizeof *result, IRT_PC);
  *result = block;
  return 0;
}

// operator new and delete, by their mangled names.
IRT_REDIRECTED void* irt_vc__Znwm(std::size_t n) {
  return allocate_or_throw(n, default_alignment, IRT_PC);
}
IRT_REDIRECTED void* irt_vc__Znam(std::size_t n) {
  return allocate_or_throw(n, default_alignment, IRT_PC);
}
IRT_REDIRECTED void* irt_vc__ZnwmSt11align_val_t(std::size_t n, std::size_t alignment) {
  return allocate_or_throw(n, alignment, IRT_PC);
}
IRT_REDIRECTED void* irt_vc__ZnamSt11align_val_t(std::size_t n, std::size_t alignment) {
  return allocate_or_throw(n, alignment, IRT_PC);
}
IRT_REDIRECTED void* irt_vc__ZnwmRKSt9nothrow_t(std::size_t n, const void*) {
  return active->allocate(n, default_alignment, IRT_PC);
}
IRT_REDIRECTED void* irt_vc__ZnamRKSt9nothrow_t(std::size_t n, const void*) {
  return active->allocate(n, default_alignment, IRT_PC);
}
IRT_REDIRECTED void* irt_vc__ZnwmSt11align_val_tRKSt9nothrow_t(std::size_t n, std::size_t a,
                                                               const void*) {
  return active->allocate(n, a, IRT_PC);
}
IRT_REDIRECTED void* irt_vc__ZnamSt11align_val_tRKSt9nothrow_t(std::size_t n, std::size_t a,
                                                               const void*) {
  return active->allocate(n, a, IRT_PC);
}
#define IRT_DELETE(name, ...)                                                 \
  IRT_REDIRECTED void irt_vc_##name(void* block __VA_OPT__(, ) __VA_ARGS__) { \
    release(block, IRT_PC);                                                   \
  }
IRT_DELETE(_ZdlPv)
IRT_DELETE(_ZdaPv)
IRT_DELETE(_ZdlPvm, std::size_t)
IRT_DELETE(_ZdaPvm, std::size_t)
IRT_DELETE(_ZdlPvSt11align_val_t, std::size_t)
IRT_DELETE(_ZdaPvSt11align_val_t, std::size_t)
IRT_DELETE(_ZdlPvmSt11align_val_t, std::size_t, std::size_t)
IRT_DELETE(_ZdaPvmSt11align_val_t, std::size_t, std::size_t)
IRT_DELETE(_ZdlPvRKSt9nothrow_t, const void*)
IRT_DELETE(_ZdaPvRKSt9nothrow_t, const void*)
IRT_DELETE(_ZdlPvSt11align_val_tRKSt9nothrow_t, std::size_t, const void*)
IRT_DELETE(_ZdaPvSt11align_val_tRKSt9nothrow_t, std::size_t, const void*)
#undef IRT_DELETE
// What libraries in a module free that is not compiled for virtual cores, by the linker's --wrap.
asm(".globl __wrap_free\n.set __wrap_free, irt_vc_free");
asm(".globl __wrap__ZdlPv\n.set __wrap__ZdlPv, irt_vc__ZdlPv");
asm(".globl __wrap__ZdlPvm\n.set __wrap__ZdlPvm, irt_vc__ZdlPvm");
asm(".globl __wrap__ZdaPv\n.set __wrap__ZdaPv, irt_vc__ZdaPv");

// libstdc++ counts shared_ptr references without atomics while this is not zero.
extern "C" __attribute__((visibility("default"))) char irt_vc___libc_single_threaded;
char irt_vc___libc_single_threaded = 0;

// --- The end --------------------------------------------------------------------------------

IRT_REDIRECTED __attribute__((noreturn)) void irt_vc_abort() {
  active->failed("abort() was called", IRT_PC);
}
IRT_REDIRECTED __attribute__((noreturn)) void irt_vc__ZSt9terminatev() {
  active->failed("std::terminate was called", IRT_PC);
}
IRT_REDIRECTED __attribute__((noreturn)) void irt_vc___assert_fail(const char* what,
                                                                   const char* file, unsigned line,
                                                                   const char* function) {
  active->failed("assertion failed: " + std::string(what) + " (" + file + ":" +
                     std::to_string(line) + ", " + function + ")",
                 IRT_PC);
}
IRT_REDIRECTED __attribute__((noreturn)) void irt_vc__ZSt21__glibcxx_assert_failPKciS0_S0_(
    const char* file, int line, const char* function, const char* what) {
  active->failed("assertion failed: " + std::string(what) + " (" + file + ":" +
                     std::to_string(line) + ", " + function + ")",
                 IRT_PC);
}
// --- Time, and who I am ---------------------------------------------------------------------

namespace {

constexpr std::int64_t second = irt::virtual_cores::nanoseconds_per_second;

timespec timespec_of(std::int64_t time) {
  return {time / second, time % second};
}

}  // namespace

IRT_REDIRECTED int irt_vc_clock_gettime(clockid_t, timespec* time) {
  announce_write(time, sizeof *time, IRT_PC);
  *time = timespec_of(active->now());
  return 0;
}
IRT_REDIRECTED int irt_vc_timespec_get(timespec* time, int base) {
  announce_write(time, sizeof *time, IRT_PC);
  *time = timespec_of(active->now());
  return base;
}
IRT_REDIRECTED int irt_vc_gettimeofday(timeval* time, void*) {
  announce_write(time, sizeof *time, IRT_PC);
  const std::int64_t now = active->now();
  *time = {now / second, now % second / 1000};
  return 0;
}
IRT_REDIRECTED std::time_t irt_vc_time(std::time_t* time) {
  const std::time_t now = active->now() / second;
  if (time == nullptr) return now;
  announce_write(time, sizeof *time, IRT_PC);
  return *time = now;
}
IRT_REDIRECTED std::clock_t irt_vc_clock() {
  return active->now() / 1000;
}
IRT_REDIRECTED std::int64_t irt_vc__ZNSt6chrono3_V212steady_clock3nowEv() {
  return active->now();
}
IRT_REDIRECTED std::int64_t irt_vc__ZNSt6chrono3_V212system_clock3nowEv() {
  return active->now();
}
IRT_REDIRECTED int irt_vc_sched_yield() {
  active->yield(IRT_PC);
  return 0;
}
// What prelude.hpp makes of instructions: calls that leave every register as it was, but for those
// that hold the answer. Of the flags those of arithmetic are kept: `popf` would put back the trap
// flag of before, too, by which a SpinWatch has its steps made.
extern "C" {
__attribute__((visibility("hidden"))) std::uint64_t irt_vc_answers[2];
__attribute__((visibility("hidden"), used)) void irt_vc_note_pause() {
  active->pause();
}
__attribute__((visibility("hidden"), used)) void irt_vc_note_clock() {
  const auto now = static_cast<std::uint64_t>(active->now());
  irt_vc_answers[0] = now;
  irt_vc_answers[1] = current_core;
}
__attribute__((visibility("hidden"), used)) void irt_vc_note_random() {
  const std::uint64_t random = active->random();
  irt_vc_answers[0] = random;
}
}
#define IRT_INSTRUCTION(name, answer)                                          \
  asm(".pushsection .text\n.globl irt_vc_cpu_" name "\n.type irt_vc_cpu_" name \
      ", @function\nirt_vc_cpu_" name                                          \
      ":\n"                                                                    \
      "pushq %rax\nlahf\nseto %al\npushq %rax\n"                               \
      "pushq %rcx\npushq %rdx\npushq %rsi\npushq %rdi\n"                       \
      "pushq %r8\npushq %r9\npushq %r10\npushq %r11\npushq %rbp\n"             \
      "movq %rsp, %rbp\nsubq $512, %rsp\nandq $-16, %rsp\nfxsave64 (%rsp)\n"   \
      "call irt_vc_note_" name                                                 \
      "\nfxrstor64 (%rsp)\nmovq %rbp, %rsp\n"                                  \
      "popq %rbp\npopq %r11\npopq %r10\npopq %r9\npopq %r8\n"                  \
      "popq %rdi\npopq %rsi\npopq %rdx\npopq %rcx\n"                           \
      "popq %rax\naddb $127, %al\nsahf\npopq %rax\n" answer "ret\n.popsection")
IRT_INSTRUCTION("pause", "");
IRT_INSTRUCTION("clock",
                "movl irt_vc_answers(%rip), %eax\nmovl irt_vc_answers+4(%rip), %edx\n"
                "movl irt_vc_answers+8(%rip), %ecx\n");
// The answer goes to the caller's stack, above the return address.
IRT_INSTRUCTION("random",
                "pushq %rax\nmovq irt_vc_answers(%rip), %rax\nmovq %rax, 16(%rsp)\n"
                "popq %rax\n");
#undef IRT_INSTRUCTION

IRT_REDIRECTED int irt_vc_nanosleep(const timespec* time, timespec*) {
  active->sleep(nanoseconds_of(*time), IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_clock_nanosleep(clockid_t, int flags, const timespec* time, timespec*) {
  const std::int64_t begin = (flags & TIMER_ABSTIME) != 0 ? active->now() : 0;
  active->sleep(nanoseconds_of(*time) - begin, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_usleep(useconds_t microseconds) {
  active->sleep(std::int64_t{microseconds} * 1000, IRT_PC);
  return 0;
}
IRT_REDIRECTED unsigned irt_vc_sleep(unsigned seconds) {
  active->sleep(seconds * second, IRT_PC);
  return 0;
}
asm(".globl irt_vc_thrd_sleep\n.set irt_vc_thrd_sleep, irt_vc_nanosleep");
asm(".globl irt_vc_thrd_yield\n.set irt_vc_thrd_yield, irt_vc_sched_yield");
// A core's number is no pthread_t of the host, which would take it for an address.
IRT_REDIRECTED int irt_vc_pthread_getaffinity_np(pthread_t, std::size_t size, cpu_set_t* set) {
  announce_write(set, size, IRT_PC);
  return sched_getaffinity(0, size, set) == 0 ? 0 : EINVAL;
}
IRT_REDIRECTED int irt_vc_sched_getaffinity(pid_t, std::size_t size, cpu_set_t* set) {
  announce_write(set, size, IRT_PC);
  return sched_getaffinity(0, size, set);
}
IRT_REDIRECTED int irt_vc_pthread_getname_np(pthread_t, char* name, std::size_t size) {
  const std::string own = "core " + std::to_string(current_core);
  if (size <= own.size()) return ERANGE;
  announce_write(name, own.size() + 1, IRT_PC);
  std::memcpy(name, own.c_str(), own.size() + 1);
  return 0;
}
// Cores have no names, places or priorities to set.
#define IRT_SUCCEEDS(name)             \
  IRT_REDIRECTED int irt_vc_##name() { \
    return 0;                          \
  }
IRT_SUCCEEDS(pthread_setname_np)
IRT_SUCCEEDS(pthread_setaffinity_np)
IRT_SUCCEEDS(pthread_setschedparam)
IRT_SUCCEEDS(pthread_setschedprio)
IRT_SUCCEEDS(sched_setaffinity)
IRT_SUCCEEDS(sched_setscheduler)
IRT_SUCCEEDS(setpriority)
IRT_SUCCEEDS(pthread_atfork)
#undef IRT_SUCCEEDS
IRT_REDIRECTED int irt_vc_sched_getcpu() {
  return static_cast<int>(current_core);
}
IRT_REDIRECTED pid_t irt_vc_gettid() {
  return static_cast<pid_t>(current_core) + 1;
}

// --- Chance ------------------------------------------------------------------------------------

namespace irt::virtual_cores {
void fill_randomly(void* to, std::size_t size, const void* pc) {
  if (size == 0) return;
  announce_write(to, size, pc);
  auto* bytes = static_cast<unsigned char*>(to);
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < size; ++i, word >>= 8U) {
    if (i % 8 == 0) word = active->random();
    bytes[i] = static_cast<unsigned char>(word);
  }
}
}  // namespace irt::virtual_cores
using irt::virtual_cores::fill_randomly;

// std::random_device: made from a name, asked, ended.
IRT_REDIRECTED void
irt_vc__ZNSt13random_device7_M_initERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE(
    void*, const void*) {}
IRT_REDIRECTED void irt_vc__ZNSt13random_device7_M_finiEv(void*) {}
IRT_REDIRECTED unsigned irt_vc__ZNSt13random_device9_M_getvalEv(void*) {
  return static_cast<unsigned>(active->random() >> 32U);
}
IRT_REDIRECTED double irt_vc__ZNKSt13random_device13_M_getentropyEv(const void*) {
  return 32;
}
IRT_REDIRECTED ssize_t irt_vc_getrandom(void* to, std::size_t size, unsigned) {
  fill_randomly(to, size, IRT_PC);
  return static_cast<ssize_t>(size);
}
IRT_REDIRECTED int irt_vc_getentropy(void* to, std::size_t size) {
  fill_randomly(to, size, IRT_PC);
  return 0;
}
IRT_REDIRECTED std::uint32_t irt_vc_arc4random() {
  return static_cast<std::uint32_t>(active->random() >> 32U);
}
// The C library's own state would go on from one execution to the next.
IRT_REDIRECTED int irt_vc_rand() {
  return static_cast<int>(active->random() >> 33U);
}
IRT_REDIRECTED long irt_vc_random() {
  return static_cast<long>(active->random() >> 33U);
}
IRT_REDIRECTED void irt_vc_srand(unsigned) {}
IRT_REDIRECTED void irt_vc_srandom(unsigned) {}

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
