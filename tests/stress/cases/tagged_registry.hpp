/// Blocks of threads that a global reaches through pointers with bits in them: a count in the
/// highest 16 bits (`TaggedTop`), a mark in the lowest ones (`TaggedLow`), the address of a member
/// inside the block (`TaggedInside`). Healthy: the blocks are kept on purpose. `TaggedBug` never
/// hangs its block into the registry: a leak.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

enum class Link { top, low, inside, lost };

template <class T, Link how>
class TaggedCase {
 public:
  static constexpr std::string_view summary =
      "a registry of blocks reached through tagged pointers";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  TaggedCase(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    ++mine().calls;
    tasks_.push_back(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    ++mine().calls;
    if (tasks_.empty()) return false;
    task = tasks_.front();
    tasks_.erase(tasks_.begin());
    return true;
  }

 private:
  struct Block {
    std::uint64_t next = 0;
    std::size_t calls = 0;
    std::size_t rest[2]{};
  };

  static std::uint64_t link(Block* block) {
    const auto address = reinterpret_cast<std::uint64_t>(block);
    switch (how) {
      case Link::top:
        return address | std::uint64_t{0xabcd} << 48U;
      case Link::low:
        return address | 5U;
      case Link::inside:
        return reinterpret_cast<std::uint64_t>(&block->rest[1]);
      case Link::lost:
        break;
    }
    return 0;
  }

  static Block& mine() {
    static thread_local bool known = false;
    static thread_local Block* block = nullptr;
    if (!known) {
      block = new Block;
      known = true;
      block->next = registry().load(std::memory_order_relaxed);
      while (!registry().compare_exchange_weak(block->next, link(block), std::memory_order_release,
                                               std::memory_order_relaxed)) {
      }
      known = true;  // not before: the allocation may fail
    }
    return *block;
  }
  static std::atomic<std::uint64_t>& registry() {
    static std::atomic<std::uint64_t> first{0};
    return first;
  }

  std::mutex mutex_;
  std::vector<T> tasks_;
};

template <class T>
class TaggedTop : public TaggedCase<T, Link::top> {
  using TaggedCase<T, Link::top>::TaggedCase;
};
template <class T>
class TaggedLow : public TaggedCase<T, Link::low> {
  using TaggedCase<T, Link::low>::TaggedCase;
};
template <class T>
class TaggedInside : public TaggedCase<T, Link::inside> {
  using TaggedCase<T, Link::inside>::TaggedCase;
};
template <class T>
class TaggedBug : public TaggedCase<T, Link::lost> {
  using TaggedCase<T, Link::lost>::TaggedCase;
};

}  // namespace irt
