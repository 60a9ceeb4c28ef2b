/// What the C library does: locks and the allocator, as glibc 2.36 has them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "bench/many_core/machine/kernel.hpp"

namespace irt::many_core {

class CLibrary {
 public:
  CLibrary(Heap& heap, Accesses& accesses, Kernel& kernel)
      : heap_(heap), accesses_(accesses), kernel_(kernel) {}

  // As virtual_cores::Tenant has them, of the thread in progress. Blocks are those of the heap.
  bool lock(Thread& me, std::uintptr_t address, std::int64_t nanoseconds, const void* pc);
  bool try_lock(Thread& me, std::uintptr_t address, const void* pc);
  void unlock(Thread& me, std::uintptr_t address, const void* pc);
  void* allocate(Thread& me, std::size_t size, std::size_t alignment, const void* pc);
  void release(Thread& me, void* block, const void* pc);

 private:
  void charge(Thread& me, const Heap::Traffic& traffic, const void* pc);

  Heap& heap_;
  Accesses& accesses_;
  Kernel& kernel_;
};

}  // namespace irt::many_core
