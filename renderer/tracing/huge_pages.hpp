/// Memory for what is large and read here and there: hierarchies and the rays of a frame. In pages
/// of 4 KB it takes more address translations than a processor keeps at hand; a frame of the real
/// scenes takes some 10 % less time with pages of 2 MB.
#pragma once

#include <cstddef>
#include <memory_resource>

namespace irt {

/// Gives blocks of 2 MB and more on boundaries of 2 MB and asks the system to back them by huge
/// pages, which it may refuse; smaller ones are ordinary. Throws std::bad_alloc.
std::pmr::memory_resource& huge_pages();

/// The same for the standard containers.
template <class T>
struct HugePageAllocator {
  using value_type = T;

  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>& /*other*/) {
  }  // NOLINT(google-explicit-constructor)

  T* allocate(std::size_t count) {
    return static_cast<T*>(huge_pages().allocate(count * sizeof(T), alignof(T)));
  }
  void deallocate(T* data, std::size_t count) {
    huge_pages().deallocate(data, count * sizeof(T), alignof(T));
  }
  bool operator==(const HugePageAllocator&) const = default;
};

}  // namespace irt
