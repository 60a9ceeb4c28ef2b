/// Four queues of libcds: MSQueue, BasketQueue, FCQueue and SegmentedQueue, with the library's
/// defaults, but for the allocator of SegmentedQueue's segments.
///
/// When to use: MSQueue and BasketQueue beside LFREE, which is the first algorithm with another
/// maker's hazard pointers; FCQueue to see flat combining; SegmentedQueue to see what relaxed order
/// buys. When not: the processor is not x86 (see below).
///
/// How they work, and what they promise:
/// - `MSQueue`: Michael and Scott (1996). FIFO by happens-before, lock-free.
/// - `BasketQueue`: Hoffman, Shalev and Shavit (2007). Pushes that lose the race for the tail go
///   beside the winner in place of behind it. FIFO by happens-before, lock-free.
/// - `FCQueue`: Hendler, Incze, Shavit and Tzafrir (2010). Who gets the lock does everybody's
///   operations on a `std::queue`. FIFO in real time, blocking.
/// - `SegmentedQueue`: Afek, Korland and Yanovsky (2010). Segments of 16 places, taken in random
///   order. 15-relaxed FIFO, blocking: a new segment is made under a lock.
///
/// Memory: one node per task, reclaimed by the library's hazard pointers, of which it has one set
/// for the whole process; FCQueue returns its memory at once. Unbounded. Lock-free means apart from
/// the allocator.
///
/// The library moves an MSQueue's head with too weak an order for C++'s memory model
/// (github.com/khizmax/libcds issue 186; `irt check --queue libcds-queue` shows it). x86-64 does
/// not let that happen. Where memory for a node cannot be had, MSQueue, BasketQueue and
/// SegmentedQueue lose what they allocated before it.
#pragma once

#include <cds/container/basket_queue.h>
#include <cds/container/fcqueue.h>
#include <cds/container/msqueue.h>
#include <cds/container/segmented_queue.h>
#include <cds/gc/hp.h>
#include <cds/init.h>
#include <cds/threading/model.h>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {
namespace libcds {

// What the library throws at an end nobody could catch, so that it may as well end the process.
// NOLINTBEGIN(bugprone-exception-escape)

/// The library must be started once, and know each thread that reads nodes.
inline void attach_thread() {
  struct Library {
    Library() { cds::Initialize(); }
    ~Library() { cds::Terminate(); }
  };
  struct Attached {
    Attached() {
      static const Library library;
      static const cds::gc::HP hazard_pointers;
      cds::threading::Manager::attachThread();
    }
    ~Attached() { cds::threading::Manager::detachThread(); }
  };
  static thread_local const Attached attached;
}

/// `Queue` behind the contract.
template <class T, class Queue>
class Adapter {
 public:
  template <class... Arguments>
  explicit Adapter(Arguments... arguments) : queue_(arguments...) {}
  Adapter(const Adapter&) = delete;
  Adapter& operator=(const Adapter&) = delete;
  ~Adapter() { attach_thread(); }
  // NOLINTEND(bugprone-exception-escape)

  /// Adds `task`. Always true.
  bool push(unsigned /*worker*/, T task) {
    attach_thread();
    return queue_.enqueue(task);
  }

  /// Takes a task; false if it sees none.
  bool pop(unsigned /*worker*/, T& task) {
    attach_thread();
    return queue_.dequeue(task);
  }

 private:
  struct Attached {
    Attached() { attach_thread(); }
  };

  Attached before_the_queue_;
  Queue queue_;
};

/// The library gives a block back as an object of another size than it asked for, so deletion must
/// not be told a size.
template <class T>
struct UnsizedAllocator {
  using value_type = T;
  UnsizedAllocator() = default;
  template <class U>
  UnsizedAllocator(const UnsizedAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T))); }
  void deallocate(T* block, std::size_t /*count*/) { ::operator delete(block); }
  friend bool operator==(const UnsizedAllocator&, const UnsizedAllocator&) { return true; }
};

struct SegmentTraits : cds::container::segmented_queue::traits {
  using allocator = UnsizedAllocator<int>;
};

inline constexpr Claims lock_free_fifo{.ordering = Ordering::fifo_happens_before,
                                       .push = Progress::lock_free,
                                       .pop = Progress::lock_free,
                                       .reclamation = Reclamation::hazard_pointers,
                                       .survives_no_memory = false};

}  // namespace libcds

template <class T>
class LibcdsMsQueue : public libcds::Adapter<T, cds::container::MSQueue<cds::gc::HP, T>> {
 public:
  static constexpr std::string_view summary = "libcds MSQueue: Michael and Scott's";
  static constexpr Claims claims = libcds::lock_free_fifo;
  LibcdsMsQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}
};

template <class T>
class LibcdsBasketQueue : public libcds::Adapter<T, cds::container::BasketQueue<cds::gc::HP, T>> {
 public:
  static constexpr std::string_view summary = "libcds BasketQueue";
  static constexpr Claims claims = libcds::lock_free_fifo;
  LibcdsBasketQueue(unsigned /*workers*/, std::size_t /*capacity*/) {}
};

/// A thread keeps a pointer into each FCQueue that it used, under the queue's address, until it
/// ends; so no queue may be destroyed before. A queue of ours that is done is emptied and waits for
/// its next use.
template <class T>
class LibcdsFcQueue {
 public:
  static constexpr std::string_view summary = "libcds FCQueue: flat combining";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  LibcdsFcQueue(unsigned /*workers*/, std::size_t /*capacity*/) {
    const std::lock_guard lock(spares().mutex);
    if (spares().queues.empty()) {
      queue_ = std::make_unique<Queue>();
      spares().queues.reserve(++spares().made);
    } else {
      queue_ = std::move(spares().queues.back());
      spares().queues.pop_back();
    }
  }
  LibcdsFcQueue(const LibcdsFcQueue&) = delete;
  LibcdsFcQueue& operator=(const LibcdsFcQueue&) = delete;

  ~LibcdsFcQueue() {
    T task{};
    while (queue_->dequeue(task)) {
    }
    const std::lock_guard lock(spares().mutex);
    spares().queues.push_back(std::move(queue_));
  }

  /// Adds `task`. Blocking. Always true.
  bool push(unsigned /*worker*/, T task) { return queue_->enqueue(task); }

  /// Takes the oldest task; false if there is none. Blocking.
  bool pop(unsigned /*worker*/, T& task) { return queue_->dequeue(task); }

 private:
  using Queue = cds::container::FCQueue<T>;
  struct Spares {
    std::mutex mutex;
    std::vector<std::unique_ptr<Queue>> queues;
    std::size_t made = 0;
  };

  static Spares& spares() {
    static auto* const all = new Spares;  // never destroyed: the last thread may end after it
    return *all;
  }

  std::unique_ptr<Queue> queue_;
};

template <class T>
class LibcdsSegmentedQueue
    : public libcds::Adapter<
          T, cds::container::SegmentedQueue<cds::gc::HP, T, libcds::SegmentTraits>> {
  static constexpr std::size_t places_of_a_segment = 16;

 public:
  static constexpr std::string_view summary = "libcds SegmentedQueue, segments of 16";
  static constexpr Claims claims{.ordering = Ordering::k_relaxed_fifo,
                                 .relaxation = places_of_a_segment - 1,
                                 .reclamation = Reclamation::hazard_pointers,
                                 .survives_no_memory = false};
  LibcdsSegmentedQueue(unsigned /*workers*/, std::size_t /*capacity*/)
      : LibcdsSegmentedQueue::Adapter(places_of_a_segment) {}
};

}  // namespace irt
