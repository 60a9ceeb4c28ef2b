/// Queues of the shape of the standard's proposal as plug-ins: P0260R20, "C++ Concurrent Queues".
///
/// When to use: there is a queue with `try_push`, `try_pop` and perhaps `push`, `pop` and `close`
/// as the proposal has them, and the question what it is worth:
///
///     template <class T>
///     class MyAdapter : public irt::Conqueue<my::bounded_queue>::Adapter<T> {
///      public:
///       static constexpr std::string_view summary = "my::bounded_queue";
///       static constexpr irt::Claims claims{.ordering = irt::Ordering::fifo_real_time,
///                                           .bounded = true};
///       using irt::Conqueue<my::bounded_queue>::template Adapter<T>::Adapter;
///     };
///
/// Earlier revisions are taken as well, where `try_push` answers bool and `try_pop` an optional.
///
/// Ordering, progress, memory, bounds: those of the queue.
///
/// What the proposal allows and the contract does not: `try_push` and `try_pop` may fail for no
/// reason, or say `busy`. Such an answer is asked for again; a queue that never gives another one
/// hangs here.
#pragma once

#include <concepts>
#include <cstddef>
#include <utility>

#include "queues/work_queue.hpp"

namespace irt {

/// `Queue<T>` is made with its capacity, or without anything.
template <template <class...> class Queue>
struct Conqueue {
  template <class Q>
  static constexpr bool waits = requires(Q& queue) {
    bool(queue.pop());
    queue.close();
  };

  template <class T>
  class Adapter {
   public:
    Adapter(unsigned /*workers*/, std::size_t capacity) : queue_(made(capacity)) {}

    /// Adds `task`; false where the queue is full or closed.
    bool push(unsigned /*worker*/, T task) {
      for (;;) {
        const auto status = queue_.try_push(task);
        if constexpr (std::same_as<decltype(status), const bool>) {
          return status;
        } else {
          if (!is_busy(status)) return status == decltype(status)::success;
        }
      }
    }

    /// Takes a task; false where there is none.
    bool pop(unsigned /*worker*/, T& task) {
      for (;;) {
        auto found = queue_.try_pop();
        if (found) {
          task = std::move(*found);
          return true;
        }
        if constexpr (requires { found.error(); }) {
          if (is_busy(found.error())) continue;
        }
        return false;
      }
    }

    /// Takes a task, waiting for one; false once the queue is closed and nothing is inside.
    bool pop_wait(unsigned /*worker*/, T& task) requires waits<Queue<T>> {
      auto found = queue_.pop();
      if (!found) return false;
      task = std::move(*found);
      return true;
    }

    void close() requires waits<Queue<T>> { queue_.close(); }

   private:
    static Queue<T> made(std::size_t capacity) {
      if constexpr (std::constructible_from<Queue<T>, std::size_t>) {
        return Queue<T>(capacity);
      } else {
        return Queue<T>();
      }
    }

    template <class Status>
    static bool is_busy(Status status) {
      bool busy = false;
      if constexpr (requires { Status::busy; }) busy = status == Status::busy;
      if constexpr (requires { Status::busy_async; }) busy = busy || status == Status::busy_async;
      return busy;
    }

    Queue<T> queue_;
  };
};

}  // namespace irt
