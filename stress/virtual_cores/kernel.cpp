// What instrumented code asks of the kernel: futexes, memory, and what virtual cores refuse.
//
// Memory that is mapped is a block of the tenant's heap: at the same address in every execution,
// and freed when it is unmapped. A page of the runtime's own before it holds how many of its bytes
// are still mapped.

#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstring>
#include <linux/futex.h>
#include <map>
#include <poll.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <sys/syscall.h>

#include "stress/virtual_cores/internal.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace {

using irt::virtual_cores::active;
using irt::virtual_cores::announce_write;
using irt::virtual_cores::current_core;
using irt::virtual_cores::fill_randomly;
using irt::virtual_cores::forget_registers;
using irt::virtual_cores::host;
using irt::virtual_cores::Modification;
using irt::virtual_cores::nanoseconds_of;
using irt::virtual_cores::nanoseconds_per_second;
using irt::virtual_cores::Order;
using irt::virtual_cores::page_bytes;
using irt::virtual_cores::Range;
using irt::virtual_cores::set_errno;
using irt::virtual_cores::until;
using irt::virtual_cores::Wake;

[[noreturn]] void refuse(const std::string& what) {
  irt::virtual_cores::refuse("the code " + what + ", which virtual cores do not support");
}

std::size_t whole_pages(std::size_t bytes) {
  return (bytes + page_bytes - 1) / page_bytes * page_bytes;
}

// Where the code maps memory, by its first address. Executions before this one are in here too:
// what they had at addresses that are mapped again goes when that happens.
std::map<std::uintptr_t, std::size_t>& mappings() {
  static std::map<std::uintptr_t, std::size_t> bytes_at;
  return bytes_at;
}

void remember(std::uintptr_t begin, std::size_t bytes) {
  auto& known = mappings();
  auto old = known.upper_bound(begin);
  if (old != known.begin() && std::prev(old)->first + std::prev(old)->second > begin) --old;
  while (old != known.end() && old->first < begin + bytes) old = known.erase(old);
  known[begin] = bytes;
}

// The mapping that has all of `bytes`; an empty one if there is none.
Range mapping_around(Range bytes) {
  const auto& known = mappings();
  auto after = known.upper_bound(bytes.begin);
  if (after == known.begin()) return {};
  --after;
  const Range mapping{after->first, after->first + after->second};
  return bytes.end <= mapping.end ? mapping : Range{};
}

void clear(Range bytes, const void* pc) {
  auto* memory = reinterpret_cast<void*>(bytes.begin);
  announce_write(memory, bytes.end - bytes.begin, pc);
  std::memset(memory, 0, bytes.end - bytes.begin);
}

void* map_fixed(Range bytes, const void* pc) {
  if (mapping_around(bytes).end == 0) refuse("maps memory at an address that it has not mapped");
  clear(bytes, pc);
  return reinterpret_cast<void*>(bytes.begin);
}

void* map(std::size_t bytes, const void* pc) {
  void* block = active->allocate(page_bytes + bytes, page_bytes, pc);
  if (block == nullptr) {
    set_errno(ENOMEM);
    return MAP_FAILED;
  }
  announce_write(block, sizeof bytes, pc);
  std::memcpy(block, &bytes, sizeof bytes);
  const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(block) + page_bytes;
  remember(begin, bytes);
  clear({begin, begin + bytes}, pc);
  return reinterpret_cast<void*>(begin);
}

void unmap(Range bytes, const void* pc) {
  const Range mapping = mapping_around(bytes);
  if (mapping.end == 0) refuse("unmaps memory that it has not mapped, or several mappings at once");
  const std::uintptr_t block = mapping.begin - page_bytes;
  const std::size_t size = bytes.end - bytes.begin;
  if (size != mapping.end - mapping.begin) {
    forget_registers();
    if (active->modify({block, 8, Order::acq_rel, pc}, Modification::fetch_sub, size) != size)
      return;
  }
  active->release(reinterpret_cast<void*>(block), pc);
}

long futex(std::uintptr_t address, int operation, std::uint32_t value, const timespec* time,
           const void* pc) {
  forget_registers();
  switch (operation & FUTEX_CMD_MASK) {
    case FUTEX_WAKE:
    case FUTEX_WAKE_BITSET:
      return active->wake(address, value, pc);
    case FUTEX_WAIT:
    case FUTEX_WAIT_BITSET: {
      const bool relative = (operation & FUTEX_CMD_MASK) == FUTEX_WAIT && time != nullptr;
      switch (active->wait(address, value, relative ? nanoseconds_of(*time) : until(time), pc)) {
        case Wake::woken:
          return 0;
        case Wake::value_differs:
          return set_errno(EAGAIN);
        case Wake::timed_out:
          return set_errno(ETIMEDOUT);
      }
      break;
    }
    default:
      break;
  }
  refuse("makes futex operation " + std::to_string(operation));
}

}  // namespace

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)

// --- Memory ------------------------------------------------------------------------------------

IRT_REDIRECTED void* irt_vc_mmap(void* place, std::size_t length, int protection, int flags,
                                 int /*file*/, off_t /*offset*/) {
  if ((flags & MAP_ANONYMOUS) == 0) refuse("maps a file into memory");
  if ((protection & PROT_EXEC) != 0) refuse("maps memory for machine code");
  const auto begin = reinterpret_cast<std::uintptr_t>(place);
  const bool fixed = (flags & (MAP_FIXED | MAP_FIXED_NOREPLACE)) != 0;
  if (length == 0 || (fixed && begin % page_bytes != 0)) {
    set_errno(EINVAL);
    return MAP_FAILED;
  }
  const std::size_t bytes = whole_pages(length);
  if ((flags & MAP_FIXED_NOREPLACE) == MAP_FIXED_NOREPLACE &&
      mapping_around({begin, begin + bytes}).end != 0) {
    set_errno(EEXIST);
    return MAP_FAILED;
  }
  return fixed ? map_fixed({begin, begin + bytes}, IRT_PC) : map(bytes, IRT_PC);
}
asm(".globl irt_vc_mmap64\n.set irt_vc_mmap64, irt_vc_mmap");

IRT_REDIRECTED int irt_vc_munmap(void* place, std::size_t length) {
  const auto begin = reinterpret_cast<std::uintptr_t>(place);
  if (length == 0 || begin % page_bytes != 0) return set_errno(EINVAL);
  unmap({begin, begin + whole_pages(length)}, IRT_PC);
  return 0;
}

// Memory that may not be used yet counts as usable.
IRT_REDIRECTED int irt_vc_mprotect(void* place, std::size_t length, int protection) {
  const auto begin = reinterpret_cast<std::uintptr_t>(place);
  if (protection != (PROT_READ | PROT_WRITE) ||
      mapping_around({begin, begin + whole_pages(length)}).end == 0)
    refuse("takes from memory that it may be read or written (mprotect)");
  return 0;
}

IRT_REDIRECTED int irt_vc_madvise(void* place, std::size_t length, int advice) {
  const auto begin = reinterpret_cast<std::uintptr_t>(place);
  if (advice != MADV_DONTNEED && advice != MADV_FREE) return 0;
  const Range bytes{begin, begin + whole_pages(length)};
  if (mapping_around(bytes).end == 0) refuse("gives back memory that it has not mapped (madvise)");
  clear(bytes, IRT_PC);
  return 0;
}

// --- System calls --------------------------------------------------------------------------------

IRT_REDIRECTED long irt_vc_syscall(long number, ...) {
  std::va_list arguments;
  va_start(arguments, number);
  const auto address = va_arg(arguments, std::uintptr_t);
  const auto second = va_arg(arguments, std::uint64_t);
  const auto value = va_arg(arguments, std::uint32_t);
  const auto* time = va_arg(arguments, const timespec*);
  va_end(arguments);
  switch (number) {
    case SYS_gettid:
      return current_core + 1L;
    case SYS_getrandom:
      fill_randomly(reinterpret_cast<void*>(address), static_cast<std::size_t>(second), IRT_PC);
      return static_cast<long>(second);
    case SYS_futex:
      return futex(address, static_cast<int>(second), value, time, IRT_PC);
    default:
      refuse("makes system call " + std::to_string(number));
  }
}

// --- Refused -------------------------------------------------------------------------------------

// What would start processes nobody sees, or have the one thread that runs all cores wait for
// something outside.
#define IRT_REFUSED(name)               \
  IRT_REDIRECTED void irt_vc_##name() { \
    refuse("calls " #name "()");        \
  }
IRT_REFUSED(pthread_kill)
IRT_REFUSED(pthread_cancel)
IRT_REFUSED(pthread_getattr_np)
IRT_REFUSED(fork)
IRT_REFUSED(vfork)
IRT_REFUSED(mremap)
IRT_REFUSED(shmat)
IRT_REFUSED(shm_open)
IRT_REFUSED(sem_open)
IRT_REFUSED(mq_open)
IRT_REFUSED(pipe)
IRT_REFUSED(pipe2)
IRT_REFUSED(eventfd)
IRT_REFUSED(timerfd_create)
IRT_REFUSED(signalfd)
IRT_REFUSED(socket)
IRT_REFUSED(socketpair)
IRT_REFUSED(ppoll)
IRT_REFUSED(pselect)
IRT_REFUSED(epoll_create)
IRT_REFUSED(epoll_create1)
IRT_REFUSED(pause)
IRT_REFUSED(sigwait)
IRT_REFUSED(sigsuspend)
#undef IRT_REFUSED
// A test framework does so for itself.
IRT_REDIRECTED int irt_vc_sigaction(int number, const struct sigaction* now,
                                    struct sigaction* before) {
  if (current_core != host) refuse("calls sigaction()");
  return sigaction(number, now, before);
}
// Without files both only sleep, and much code in C knows no other way.
IRT_REDIRECTED int irt_vc_poll(pollfd*, nfds_t count, int milliseconds) {
  if (count != 0 || milliseconds < 0) refuse("calls poll()");
  active->sleep(std::int64_t{milliseconds} * 1'000'000, IRT_PC);
  return 0;
}
IRT_REDIRECTED int irt_vc_select(int count, fd_set*, fd_set*, fd_set*, timeval* time) {
  if (count != 0 || time == nullptr) refuse("calls select()");
  active->sleep(time->tv_sec * nanoseconds_per_second + time->tv_usec * 1'000, IRT_PC);
  return 0;
}

// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
// NOLINTEND(performance-no-int-to-ptr)
