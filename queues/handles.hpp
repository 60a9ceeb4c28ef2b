/// Queues that want an object of their own for each who calls them, as queues of workers.
#pragma once

#include <concepts>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "queues/cache_line.hpp"
#include "queues/claims.hpp"

namespace irt {

// clang-format off

/// The methods of `Q` take a `Q::Handle` in place of a worker's number.
template <class Q, class T>
concept TakesHandles =
    std::constructible_from<typename Q::Handle, Q&> &&
    requires(Q& queue, typename Q::Handle& handle, T task) {
      { queue.push(handle, std::move(task)) } -> std::same_as<bool>;
      { queue.pop(handle, task) } -> std::same_as<bool>;
    };

// clang-format on

/// A queue that takes handles, of elements `T`, for so many workers. A worker's handle is made in
/// its first call, by the thread that makes it, and destroyed by the one in which it leaves.
template <class Q, class T>
class WithWorkers {
  using Handle = typename Q::Handle;

 public:
  static constexpr std::string_view summary = Q::summary;
  static constexpr Claims claims = Q::claims;

  WithWorkers(unsigned workers, std::size_t capacity)
      : queue_(workers, capacity), places_(workers) {}

  bool push(unsigned worker, T task) { return queue_.push(handle(worker), std::move(task)); }
  bool pop(unsigned worker, T& task) { return queue_.pop(handle(worker), task); }
  void leave(unsigned worker) { places_[worker].handle.reset(); }

  // As far as the queue has them, with what it answers.
  template <class... Until>
  auto pop_wait(unsigned worker, T& task, Until... until) requires requires(Q& queue, Handle& own) {
    queue.pop_wait(own, task, until...);
  }
  { return queue_.pop_wait(handle(worker), task, until...); }
  auto close() requires requires(Q& queue) { queue.close(); }
  { return queue_.close(); }
  auto push_bulk(unsigned worker, std::span<const T> tasks) requires
      requires(Q& queue, Handle& own) {
    queue.push_bulk(own, tasks);
  }
  { return queue_.push_bulk(handle(worker), tasks); }
  auto pop_bulk(unsigned worker, std::span<T> tasks) requires requires(Q& queue, Handle& own) {
    queue.pop_bulk(own, tasks);
  }
  { return queue_.pop_bulk(handle(worker), tasks); }

 private:
  struct alignas(cache_line_pair) Place {
    std::optional<Handle> handle;
  };

  Handle& handle(unsigned worker) {
    std::optional<Handle>& own = places_[worker].handle;
    if (!own) own.emplace(queue_);
    return *own;
  }

  Q queue_;
  std::deque<Place> places_;  // a handle may not be movable; they go before the queue
};

/// `Q` as a queue of workers: itself, or with its handles made for it.
template <class Q, class T>
struct ByWorkerOf {
  using type = Q;
};
template <class Q, class T>
requires TakesHandles<Q, T>
struct ByWorkerOf<Q, T> {
  using type = WithWorkers<Q, T>;
};
template <class Q, class T>
using ByWorker = typename ByWorkerOf<Q, T>::type;

}  // namespace irt
