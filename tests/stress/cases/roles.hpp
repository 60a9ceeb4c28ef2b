/// Healthy queues that trust the contract: one worker alone pops, and another thread acts for a
/// worker only after the one before has returned. They trap where somebody does otherwise.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

/// What one worker does, and nobody else meanwhile.
class Part {
 public:
  /// Takes part as `worker`.
  explicit Part(unsigned worker, std::optional<unsigned>& mine, bool& busy) : busy_(busy) {
    if (busy || mine.value_or(worker) != worker) __builtin_trap();
    busy = true;
    mine = worker;
  }
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  ~Part() { busy_ = false; }

 private:
  bool& busy_;
};

/// A ring for one producer and one consumer that knows them.
template <class T>
class KnowsItsWorkers {
 public:
  static constexpr std::string_view summary = "a ring that knows its producer and its consumer";
  static constexpr Claims claims{.ordering = Ordering::fifo_happens_before,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .bounded = true,
                                 .producers = Callers::one,
                                 .consumers = Callers::one,
                                 .reclamation = Reclamation::preallocated};

  KnowsItsWorkers(unsigned /*workers*/, std::size_t capacity) : places_(capacity + 1) {}

  bool push(unsigned worker, T task) {
    const Part part(worker, producer_, pushing_);
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = (tail + 1) % places_.size();
    if (next == head_.load(std::memory_order_acquire)) return false;
    places_[tail] = task;
    tail_.store(next, std::memory_order_release);
    return true;
  }

  bool pop(unsigned worker, T& task) {
    const Part part(worker, consumer_, popping_);
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    task = places_[head];
    head_.store((head + 1) % places_.size(), std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> places_;
  std::atomic<std::size_t> head_{0};
  std::atomic<std::size_t> tail_{0};
  std::optional<unsigned> producer_, consumer_;
  bool pushing_ = false, popping_ = false;
};

/// A stack for many producers that the one consumer, which it knows, takes whole and turns round.
template <class T>
class KnowsItsConsumer {
 public:
  static constexpr std::string_view summary = "a list for many producers that knows its consumer";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .consumers = Callers::one};

  KnowsItsConsumer(unsigned /*workers*/, std::size_t /*capacity*/) {}
  KnowsItsConsumer(const KnowsItsConsumer&) = delete;
  KnowsItsConsumer& operator=(const KnowsItsConsumer&) = delete;
  ~KnowsItsConsumer() {
    free(taken_);
    free(pushed_.load(std::memory_order_relaxed));
  }

  bool push(unsigned /*worker*/, T task) {
    Node* node = new Node{task, pushed_.load(std::memory_order_relaxed)};
    while (!pushed_.compare_exchange_weak(node->next, node, std::memory_order_release,
                                          std::memory_order_relaxed)) {
    }
    return true;
  }

  bool pop(unsigned worker, T& task) {
    const Part part(worker, consumer_, popping_);
    if (taken_ == nullptr) {
      for (Node* node = pushed_.exchange(nullptr, std::memory_order_acquire); node != nullptr;) {
        Node* next = node->next;
        node->next = taken_;
        taken_ = node;
        node = next;
      }
    }
    if (taken_ == nullptr) return false;
    Node* first = taken_;
    taken_ = first->next;
    task = first->task;
    delete first;
    return true;
  }

 private:
  struct Node {
    T task;
    Node* next;
  };
  static void free(Node* node) {
    while (node != nullptr) {
      Node* next = node->next;
      delete node;
      node = next;
    }
  }

  std::atomic<Node*> pushed_{nullptr};
  Node* taken_ = nullptr;
  std::optional<unsigned> consumer_;
  bool popping_ = false;
};

/// A queue for each worker that notices when two act for it.
template <class T>
class KnowsEachWorker {
 public:
  static constexpr std::string_view summary = "a queue for each worker, for one at a time";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .producers = Callers::own_worker,
                                 .consumers = Callers::own_worker};

  KnowsEachWorker(unsigned workers, std::size_t /*capacity*/) : lists_(workers) {}

  bool push(unsigned worker, T task) {
    List& list = lists_[worker];
    const Part part(worker, list.worker, list.busy);
    counted_.fetch_add(1);
    list.held.push_back(task);
    return true;
  }

  bool pop(unsigned worker, T& task) {
    List& list = lists_[worker];
    const Part part(worker, list.worker, list.busy);
    counted_.fetch_add(1);
    if (list.held.empty()) return false;
    task = list.held.front();
    list.held.erase(list.held.begin());
    return true;
  }

 private:
  struct List {
    std::vector<T> held;
    std::optional<unsigned> worker;
    bool busy = false;
  };
  std::vector<List> lists_;
  std::atomic<std::size_t> counted_{0};  // a step at which a thread can be stopped
};

}  // namespace irt
