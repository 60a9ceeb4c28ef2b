/// LOCAL: a queue for each worker, without any synchronisation (thesis 7.2).
///
/// When to use: the application can deal the work evenly beforehand. The thesis deals primary
/// tasks round-robin; each worker keeps the tasks that come out of its own. When not: loads differ,
/// for a worker that has finished cannot help another.
///
/// Ordering: FIFO for each worker's queue; nothing between workers. Progress: wait-free, apart from
/// the allocator. Memory: one node per task, deleted at once. Unbounded.
///
/// How it works: the list of listing 7.1 without its locks, as the thesis says, one per worker and
/// each on cache lines of its own, so that workers do not slow each other. As in `TwoLockQueue`,
/// `pop` returns the value of the new sentinel, where the listing returns that of the old one.
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class LocalQueues {
 public:
  static constexpr std::string_view summary =
      "LOCAL (thesis 7.2): an unsynchronised queue for each worker";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .producers = Callers::own_worker,
                                 .consumers = Callers::own_worker,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  LocalQueues(unsigned workers, std::size_t /*capacity*/) : lists_(workers) {}

  /// Adds `task` at the back of `worker`'s queue. Wait-free. Always true.
  bool push(unsigned worker, T task) {
    List& list = lists_[worker];
    list.tail->next = new Node{std::move(task)};
    list.tail = list.tail->next;
    return true;
  }

  /// Takes the oldest task of `worker`'s queue; false if there is none. Wait-free.
  bool pop(unsigned worker, T& task) {
    List& list = lists_[worker];
    Node* first = list.head->next;
    if (first == nullptr) return false;
    task = std::move(first->task);
    delete list.head;
    list.head = first;
    return true;
  }

 private:
  struct Node {
    T task{};
    Node* next = nullptr;
  };

  struct alignas(cache_line_pair) List {
    List() = default;
    List(const List&) = delete;
    List& operator=(const List&) = delete;
    ~List() {
      while (head != nullptr) {
        Node* next = head->next;
        delete head;
        head = next;
      }
    }

    Node* head = new Node;
    Node* tail = head;
  };

  std::vector<List> lists_;
};

}  // namespace irt
