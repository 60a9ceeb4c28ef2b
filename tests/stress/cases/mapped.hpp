/// Queues whose nodes the kernel maps. What one thread has unmapped, another may be given at the
/// same address, and nothing but the kernel orders the two: that is no data race.
#pragma once

#include <atomic>
#include <cstddef>
#include <new>
#include <string_view>
#include <sys/mman.h>

#include "queues/work_queue.hpp"

namespace irt {

/// One page by itself.
struct Pages {
  static void* map() {
    void* page = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return page == MAP_FAILED ? nullptr : page;
  }
  static void unmap(void* page) { munmap(page, 4096); }
};

/// A page at a multiple of four, cut out of a larger piece, as one gets memory that is aligned.
struct AlignedPages {
  static void* map() {
    char* const piece = static_cast<char*>(
        mmap(nullptr, 7 * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0));
    if (piece == MAP_FAILED) return nullptr;
    const std::size_t before =
        (4 * page - reinterpret_cast<std::size_t>(piece) % (4 * page)) % (4 * page);
    if (before != 0) munmap(piece, before);
    char* const kept = piece + before;
    const std::size_t after = 7 * page - before - 2 * page;
    if (after != 0) munmap(kept + 2 * page, after);
    mprotect(kept, 2 * page, PROT_READ | PROT_WRITE);
    return kept;
  }
  static void unmap(void* place) { munmap(place, 2 * page); }

 private:
  static constexpr std::size_t page = 4096;
};

/// What is unmapped too late, too early or never.
enum class Unmapping { right, before_it_is_read, never };

/// One producer, one consumer, a list with a node that is empty at its beginning.
template <class T, class Memory, Unmapping unmapping = Unmapping::right>
class MappedList {
 public:
  static constexpr std::string_view summary = "a list of mapped pages for one producer";
  static constexpr Claims claims{.push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .producers = Callers::one,
                                 .consumers = Callers::one};

  MappedList(unsigned /*workers*/, std::size_t /*capacity*/) : first_(make()), last_(first_) {
    if (first_ == nullptr) throw std::bad_alloc();
  }
  MappedList(const MappedList&) = delete;
  MappedList& operator=(const MappedList&) = delete;
  ~MappedList() {
    T task;
    while (pop(0, task)) {
    }
    Memory::unmap(first_);
  }

  bool push(unsigned /*worker*/, T task) {
    Node* const node = make();
    if (node == nullptr) return false;
    node->task = task;
    last_->next.store(node, std::memory_order_release);  // with the acquire of pop
    last_ = node;
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    Node* const next = first_->next.load(std::memory_order_acquire);  // with the release of push
    if (next == nullptr) return false;
    if (unmapping == Unmapping::before_it_is_read) Memory::unmap(next);
    task = next->task;
    if (unmapping == Unmapping::right) Memory::unmap(first_);
    first_ = next;
    return true;
  }

 private:
  struct Node {
    std::atomic<Node*> next{nullptr};
    T task{};
  };

  static Node* make() {
    void* const place = Memory::map();
    return place == nullptr ? nullptr : ::new (place) Node;
  }

  Node* first_;
  Node* last_;
};

template <class T>
using MappedPages = MappedList<T, Pages>;
template <class T>
using MappedAligned = MappedList<T, AlignedPages>;
template <class T>
using MappedUsesBug = MappedList<T, Pages, Unmapping::before_it_is_read>;
template <class T>
using MappedAlignedUsesBug = MappedList<T, AlignedPages, Unmapping::before_it_is_read>;
template <class T>
using MappedLeaksBug = MappedList<T, Pages, Unmapping::never>;

}  // namespace irt
