#include "stress/threads/allocator.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <malloc.h>

#include "stress/threads/sanitizer.hpp"

namespace irt::stress {
namespace {

// Plain thread-locals in the executable: no lazy allocation on first use, safe inside malloc.
thread_local int depth = 0;
thread_local bool counts = false;
thread_local bool outside_accounting = false;
thread_local std::uint64_t seen_allocations = 0;
thread_local std::uint64_t failing = 0;

std::atomic<bool> accounting{false};
std::atomic<std::int64_t> live_blocks{0};
std::atomic<std::int64_t> live_bytes{0};

}  // namespace

bool allocator_is_watched() {
  return sanitizer == Sanitizer::none;
}
bool in_allocator() {
  return depth > 0;
}

Accounting::Accounting() {
  live_blocks.store(0, std::memory_order_relaxed);
  live_bytes.store(0, std::memory_order_relaxed);
  accounting.store(true, std::memory_order_relaxed);
}
Accounting::~Accounting() {
  accounting.store(false, std::memory_order_relaxed);
}
Live Accounting::live() {
  return {live_blocks.load(std::memory_order_relaxed), live_bytes.load(std::memory_order_relaxed)};
}

OutsideAccounting::OutsideAccounting() {
  outside_accounting = true;
}
OutsideAccounting::~OutsideAccounting() {
  outside_accounting = false;
}

FailingAllocation::FailingAllocation(std::uint64_t k) {
  seen_allocations = 0;
  failing = k;
  counts = true;
}
FailingAllocation::~FailingAllocation() {
  counts = false;
}
std::uint64_t FailingAllocation::seen() {
  return seen_allocations;
}

#if !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
namespace {

/// The calling thread is inside the allocator.
struct Inside {
  Inside() { ++depth; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  ~Inside() { --depth; }
};

bool fails() {
  return counts && ++seen_allocations == failing;
}

bool counted(const void* block) {
  return block != nullptr && !outside_accounting && accounting.load(std::memory_order_relaxed);
}

void* given(void* block) {
  if (counted(block)) {
    live_blocks.fetch_add(1, std::memory_order_relaxed);
    live_bytes.fetch_add(static_cast<std::int64_t>(malloc_usable_size(block)),
                         std::memory_order_relaxed);
  }
  return block;
}

void taken(void* block) {
  if (counted(block)) {
    live_blocks.fetch_sub(1, std::memory_order_relaxed);
    live_bytes.fetch_sub(static_cast<std::int64_t>(malloc_usable_size(block)),
                         std::memory_order_relaxed);
  }
}

void* refuse() {
  errno = ENOMEM;
  return nullptr;
}

}  // namespace

// glibc's own entry points, by the names it exports for replacements like this one.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" {
void* __libc_malloc(std::size_t size);
void __libc_free(void* block);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  const Inside inside;
  return fails() ? refuse() : given(__libc_malloc(size));
}
void free(void* block) noexcept {
  const Inside inside;
  taken(block);
  __libc_free(block);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  const Inside inside;
  return fails() ? refuse() : given(__libc_calloc(count, size));
}
void* realloc(void* block, std::size_t size) noexcept {
  const Inside inside;
  if (fails()) return refuse();
  taken(block);
  void* moved = __libc_realloc(block, size);
  given(moved != nullptr || size == 0 ? moved : block);
  return moved;
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  const Inside inside;
  return fails() ? refuse() : given(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  void* found = memalign(alignment, size);
  if (found == nullptr) return ENOMEM;
  *block = found;
  return 0;
}
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
#endif

}  // namespace irt::stress
