#include "bench/micro/allocations.hpp"

#include <cerrno>
#include <cstddef>

namespace {
thread_local constinit irt::micro::Allocations counts;
}  // namespace

namespace irt::micro {
Allocations allocations() {
  return counts;
}
}  // namespace irt::micro

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// glibc lets a program bring functions of these names and has its own under others; memory still
// comes from glibc, so its free() stays in use. `operator new` comes through here too.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) {
  ++counts.count;
  counts.bytes += bytes;
  return __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) {
  ++counts.count;
  counts.bytes += count * bytes;
  return __libc_calloc(count, bytes);
}

void* memalign(std::size_t alignment, std::size_t bytes) {
  ++counts.count;
  counts.bytes += bytes;
  return __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  return memalign(alignment, bytes);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) {
  *memory = memalign(alignment, bytes);
  return *memory == nullptr ? ENOMEM : 0;
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

#endif
