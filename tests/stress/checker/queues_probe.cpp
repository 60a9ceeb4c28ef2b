// Queues to try the checker on: healthy ones, and each fault that the checker must find. Michael
// and Scott's queue keeps its nodes until it is destroyed, as other checkers' benchmarks have it.

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "queues/lock_free/lcrq.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace {

using irt::Claims;
using irt::Ordering;
using irt::Progress;
using irt::Reclamation;

constexpr auto rlx = std::memory_order_relaxed;
constexpr auto acq = std::memory_order_acquire;
constexpr auto rel = std::memory_order_release;

enum class Fault { none, relaxed_publish, relaxed_head, value_after_cas, delete_now, no_help };

template <class T, Fault fault>
class Linked {
 public:
  static constexpr std::string_view summary = "Michael and Scott's queue, with a fault or none";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::at_destruction};

  Linked(unsigned, std::size_t) : head_(new Node), tail_(head_.load(rlx)) {
    first_ = head_.load(rlx);
  }
  ~Linked() {
    for (Node* node = fault == Fault::delete_now ? head_.load(rlx) : first_; node != nullptr;) {
      Node* next = node->next.load(rlx);
      delete node;
      node = next;
    }
  }

  bool push(unsigned, T task) {
    Node* node = new Node{task};
    for (;;) {
      Node* tail = tail_.load(acq);
      Node* next = tail->next.load(acq);
      if (next == nullptr) {
        if (tail->next.compare_exchange_strong(next, node,
                                               fault == Fault::relaxed_publish ? rlx : rel, rlx)) {
          if (fault != Fault::no_help) tail_.compare_exchange_strong(tail, node, rel, rlx);
          return true;
        }
      } else if (fault != Fault::no_help) {
        tail_.compare_exchange_strong(tail, next, rel, rlx);
      }
    }
  }

  bool pop(unsigned, T& task) {
    for (;;) {
      Node* head = head_.load(acq);
      Node* next = head->next.load(acq);
      if (next == nullptr) return false;
      Node* tail = tail_.load(acq);
      if (head == tail) tail_.compare_exchange_strong(tail, next, rel, rlx);
      const T value = next->task;
      Node* expected = head;
      if (head_.compare_exchange_strong(expected, next, fault == Fault::relaxed_head ? rlx : rel,
                                        rlx)) {
        task = value;
        if (fault == Fault::delete_now) delete head;
        if (fault == Fault::value_after_cas) {
          task = next->task;
          next->task = T{};
        }
        return true;
      }
    }
  }

 private:
  struct Node {
    T task{};
    std::atomic<Node*> next{nullptr};
  };
  std::atomic<Node*> head_, tail_;
  Node* first_;
};

/// Two locks, and a plain `next` that both sides touch when the queue is nearly empty.
template <class T>
class TwoLocks {
 public:
  static constexpr std::string_view summary = "two locks, a plain link";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before};

  TwoLocks(unsigned, std::size_t) : head_(new Node), tail_(head_) {}
  ~TwoLocks() {
    while (head_ != nullptr) delete std::exchange(head_, head_->next);
  }
  bool push(unsigned, T task) {
    Node* node = new Node{task};
    const std::lock_guard lock(tail_mutex_);
    tail_ = tail_->next = node;
    return true;
  }
  bool pop(unsigned, T& task) {
    const std::lock_guard lock(head_mutex_);
    Node* next = head_->next;
    if (next == nullptr) return false;
    task = next->task;
    delete std::exchange(head_, next);
    return true;
  }

 private:
  struct Node {
    T task{};
    Node* next = nullptr;
  };
  std::mutex head_mutex_, tail_mutex_;
  Node *head_, *tail_;
};

/// Vyukov's bounded ring. With a false claim: a producer that stops between taking a slot and
/// filling it hides what was pushed after it.
/// One lock around everything. `forgetful`: a pop asks for memory when it has taken its element.
template <class T, bool forgetful>
class OneLock {
 public:
  static constexpr std::string_view summary = "a list under one lock";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  OneLock(unsigned, std::size_t) {}
  ~OneLock() {
    T task;
    while (take(task)) {
    }
  }

  bool push(unsigned, T task) {
    auto node = std::make_unique<Node>(task);
    const std::lock_guard lock(mutex_);
    Node* const last = node.release();
    (last_ != nullptr ? last_->next : first_) = last;
    last_ = last;
    return true;
  }
  bool pop(unsigned, T& task) {
    if (!take(task)) return false;
    if (!forgetful) return true;
    const std::lock_guard lock(mutex_);
    receipt_ = std::make_unique<Node>(task);
    return true;
  }

 private:
  struct Node {
    explicit Node(T t) : task(t) {}
    T task;
    Node* next = nullptr;
  };

  bool take(T& task) {
    const std::lock_guard lock(mutex_);
    if (first_ == nullptr) return false;
    const std::unique_ptr<Node> node(first_);
    first_ = node->next;
    if (first_ == nullptr) last_ = nullptr;
    task = node->task;
    return true;
  }

  std::mutex mutex_;
  Node* first_ = nullptr;
  Node* last_ = nullptr;
  std::unique_ptr<Node> receipt_;
};

template <class T, bool claims_lock_free>
class Ring {
 public:
  static constexpr std::string_view summary = "Vyukov's ring";
  static constexpr Claims claims{
      .ordering = Ordering::per_producer_fifo,
      .push = claims_lock_free ? Progress::lock_free : Progress::blocking,
      .pop = claims_lock_free ? Progress::lock_free : Progress::blocking,
      .bounded = true,
      .reclamation = Reclamation::preallocated};

  Ring(unsigned, std::size_t capacity) : size(std::max<std::size_t>(capacity, 2)), slots_(size) {
    for (std::size_t i = 0; i < size; ++i) slots_[i].sequence.store(i, rlx);
  }
  bool push(unsigned, T task) {
    std::size_t at = tail_.load(rlx);
    for (;;) {
      Slot& slot = slots_[at % size];
      const std::size_t sequence = slot.sequence.load(acq);
      if (sequence == at) {
        if (!tail_.compare_exchange_strong(at, at + 1, rlx)) continue;
        slot.task = task;
        slot.sequence.store(at + 1, rel);
        return true;
      }
      if (sequence < at) return false;
      at = tail_.load(rlx);
    }
  }
  bool pop(unsigned, T& task) {
    std::size_t at = head_.load(rlx);
    for (;;) {
      Slot& slot = slots_[at % size];
      const std::size_t sequence = slot.sequence.load(acq);
      if (sequence == at + 1) {
        if (!head_.compare_exchange_strong(at, at + 1, rlx)) continue;
        task = slot.task;
        slot.sequence.store(at + size, rel);
        return true;
      }
      if (sequence < at + 1) return false;
      at = head_.load(rlx);
    }
  }

 private:
  struct Slot {
    std::atomic<std::size_t> sequence;
    T task;
  };
  std::size_t size;
  std::vector<Slot> slots_;
  std::atomic<std::size_t> head_{0}, tail_{0};
};

/// LCRQ with something behind its elements, as tasks have, which a pop must see as written.
template <class T>
class BoxedLcrq {
 public:
  static constexpr std::string_view summary = "LCRQ, elements in boxes";
  static constexpr Claims claims = irt::Lcrq<T*>::claims;

  BoxedLcrq(unsigned workers, std::size_t capacity) : queue_(workers, capacity) {}

  bool push(unsigned worker, T task) { return queue_.push(worker, new T(task)); }
  bool pop(unsigned worker, T& task) {
    T* box = nullptr;
    if (!queue_.pop(worker, box)) return false;
    task = *box;
    delete box;
    return true;
  }

 private:
  irt::Lcrq<T*> queue_;
};

/// A bag that hands its elements over with one exchange: each leaves once, whatever the order, and
/// what it points to is published by an order that is strong enough only.
template <class T, std::memory_order order>
class Bag {
 public:
  static constexpr std::string_view summary = "a bag";
  static constexpr Claims claims{.bounded = true, .reclamation = Reclamation::preallocated};

  Bag(unsigned, std::size_t capacity) : places_(capacity) {}
  bool push(unsigned, T task) {
    for (auto& place : places_) {
      std::uint64_t none = 0;
      if (place.compare_exchange_strong(none, irt::word_of(task), order, rlx)) return true;
    }
    return false;
  }
  bool pop(unsigned, T& task) {
    for (auto& place : places_) {
      const std::uint64_t word = place.exchange(0, order);
      if (word == 0) continue;
      task = irt::element_of<T>(word);
      return true;
    }
    return false;
  }

 private:
  std::vector<std::atomic<std::uint64_t>> places_;
};

template <class T>
using PublishingBag = Bag<T, std::memory_order_acq_rel>;
template <class T>
using UnpublishedBag = Bag<T, rlx>;
template <class T>
using HalfPublishedBag = Bag<T, rel>;
template <class T>
using Healthy = Linked<T, Fault::none>;
template <class T>
using RelaxedPublish = Linked<T, Fault::relaxed_publish>;
template <class T>
using RelaxedHead = Linked<T, Fault::relaxed_head>;
template <class T>
using ValueAfterCas = Linked<T, Fault::value_after_cas>;
template <class T>
using DeleteNow = Linked<T, Fault::delete_now>;
template <class T>
using NoHelp = Linked<T, Fault::no_help>;
template <class T>
using Locked = OneLock<T, false>;
template <class T>
using Forgetful = OneLock<T, true>;
template <class T>
using HonestRing = Ring<T, false>;
template <class T>
using BoastfulRing = Ring<T, true>;

constexpr irt::QueueEntry entries[] = {
    irt::queue_entry<PublishingBag>("publishing-bag"),
    irt::queue_entry<UnpublishedBag>("unpublished-bag"),
    irt::queue_entry<HalfPublishedBag>("half-published-bag"),
    irt::queue_entry<Healthy>("healthy"),
    irt::queue_entry<RelaxedPublish>("relaxed-publish"),
    irt::queue_entry<RelaxedHead>("relaxed-head"),
    irt::queue_entry<ValueAfterCas>("value-after-cas"),
    irt::queue_entry<DeleteNow>("delete-now"),
    irt::queue_entry<NoHelp>("no-help"),
    irt::queue_entry<TwoLocks>("two-locks"),
    irt::queue_entry<Locked>("locked"),
    irt::queue_entry<Forgetful>("forgetful"),
    irt::queue_entry<HonestRing>("honest-ring"),
    irt::queue_entry<BoastfulRing>("boastful-ring"),
    irt::queue_entry<irt::Lcrq>("lcrq"),
    irt::queue_entry<BoxedLcrq>("boxed-lcrq"),
};

}  // namespace

extern "C" const irt::QueueEntry* irt_probe_entries(unsigned* count) {
  *count = sizeof entries / sizeof *entries;
  return entries;
}
