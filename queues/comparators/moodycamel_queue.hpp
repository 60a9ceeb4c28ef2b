/// moodycamel's `ConcurrentQueue`, without tokens and with one of each kind for every worker.
///
/// When to use: throughput counts and order does not; with tokens wherever threads can keep one,
/// which is what the author recommends. When not: elements must leave in the order in which threads
/// saw each other push them: the queue is one list for each producer, and consumers go round.
///
/// Ordering: with tokens FIFO for each producer. Without, FIFO for each *thread*, so a worker whose
/// thread changes has none. A pop may miss what is there. Progress: lock-free, apart from the
/// allocator. Memory: blocks of 32 elements, kept for reuse and returned at destruction. Unbounded;
/// `capacity` is a first helping.
///
/// How it works: a producer fills blocks of its own; an index made by fetch-and-add deals what is
/// in them to consumers. Without a token, push looks its thread up in a hash table and pop has no
/// memory of where it found something last.
#pragma once

#include <concurrentqueue/concurrentqueue.h>
#include <cstddef>
#include <deque>
#include <new>
#include <span>
#include <string_view>
#include <utility>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <class T>
class MoodycamelQueue {
 public:
  static constexpr std::string_view summary = "moodycamel ConcurrentQueue, without tokens";
  static constexpr Claims claims{.ordering = Ordering::unordered,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .reclamation = Reclamation::free_list,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  MoodycamelQueue(unsigned /*workers*/, std::size_t capacity) : queue_(capacity) {}

  /// Adds `task`. Lock-free. Always true.
  bool push(unsigned /*worker*/, T task) { return queue_.enqueue(std::move(task)); }

  /// Takes a task; false if it sees none. Lock-free.
  bool pop(unsigned /*worker*/, T& task) { return queue_.try_dequeue(task); }

  /// Adds all of `tasks`. Lock-free.
  std::size_t push_bulk(unsigned /*worker*/, std::span<const T> tasks) {
    return queue_.enqueue_bulk(tasks.data(), tasks.size()) ? tasks.size() : 0;
  }

  /// Takes as many tasks as it sees. Lock-free.
  std::size_t pop_bulk(unsigned /*worker*/, std::span<T> tasks) {
    return queue_.try_dequeue_bulk(tasks.data(), tasks.size());
  }

 private:
  moodycamel::ConcurrentQueue<T> queue_;
};

template <class T>
class MoodycamelTokenQueue {
 public:
  static constexpr std::string_view summary = "moodycamel ConcurrentQueue, tokens for each worker";
  static constexpr Claims claims{.ordering = Ordering::per_producer_fifo,
                                 .push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .empty = Answer::this_worker,
                                 .reclamation = Reclamation::free_list,
                                 .elements = {.large = true, .owner = true, .copied = true}};

  MoodycamelTokenQueue(unsigned workers, std::size_t capacity) : queue_(capacity) {
    for (unsigned worker = 0; worker < workers; ++worker)
      // The library does not throw here, and crashes later.
      if (!tokens_.emplace_back(queue_).producer.valid()) throw std::bad_alloc();
  }

  /// Adds `task`. Lock-free. Always true.
  bool push(unsigned worker, T task) {
    return queue_.enqueue(tokens_[worker].producer, std::move(task));
  }

  /// Takes a task; false if it sees none. Lock-free.
  bool pop(unsigned worker, T& task) { return queue_.try_dequeue(tokens_[worker].consumer, task); }

  /// Adds all of `tasks`. Lock-free.
  std::size_t push_bulk(unsigned worker, std::span<const T> tasks) {
    return queue_.enqueue_bulk(tokens_[worker].producer, tasks.data(), tasks.size()) ? tasks.size()
                                                                                     : 0;
  }

  /// Takes as many tasks as it sees. Lock-free.
  std::size_t pop_bulk(unsigned worker, std::span<T> tasks) {
    return queue_.try_dequeue_bulk(tokens_[worker].consumer, tasks.data(), tasks.size());
  }

 private:
  using Queue = moodycamel::ConcurrentQueue<T>;
  struct alignas(cache_line_pair) Tokens {
    explicit Tokens(Queue& queue) : producer(queue), consumer(queue) {}
    moodycamel::ProducerToken producer;
    moodycamel::ConsumerToken consumer;
  };

  Queue queue_;
  std::deque<Tokens> tokens_;
};

}  // namespace irt
