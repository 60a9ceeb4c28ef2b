#include "renderer/tracing/huge_pages.hpp"

#include <new>
#include <sys/mman.h>

namespace irt {
namespace {

constexpr std::size_t huge = std::size_t{2} << 20;

class HugePages final : public std::pmr::memory_resource {
  static std::size_t whole(std::size_t bytes) { return (bytes + huge - 1) / huge * huge; }

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (bytes < huge || alignment > huge)
      return ::operator new (bytes, std::align_val_t{alignment});
    void* block = ::operator new (whole(bytes), std::align_val_t{huge});
    // A wish: where the system does not know huge pages the block is as good, only slower.
    static_cast<void>(madvise(block, whole(bytes), MADV_HUGEPAGE));
    return block;
  }
  void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) override {
    const std::size_t boundary = bytes < huge || alignment > huge ? alignment : huge;
    ::operator delete (block, std::align_val_t{boundary});
  }
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }
};

}  // namespace

std::pmr::memory_resource& huge_pages() {
  static HugePages all;
  return all;
}

}  // namespace irt
