/// WAITING: any queue, with a pop that waits and a way to close it.
///
/// When to use: workers that find nothing should sleep, and the queue at hand only answers *empty*.
/// When not: a queue of one's own that waits by itself is cheaper where every push is under a lock
/// anyway; each push here pays two more full barriers. Not for queues whose *empty* speaks of one
/// worker alone: who sleeps there would not hear of elements elsewhere.
///
/// Ordering, progress of `push` and `pop`, memory, bounds: those of the queue inside. A push that
/// is stopped half-way keeps waiting pops from answering *closed*, and nobody from anything else.
///
/// How it works: who finds nothing sleeps on an event count, and each push notifies one sleeper.
/// Where *empty* may be answered although an element is inside, since another call is in flight, a
/// sleeper may have gone back to sleep for such a call's sake; so whoever pops there notifies
/// another one, who looks again.
///
/// Closing is a race between a push that is under way and the waiting pop that says for good that
/// nothing is left; `closing.hpp` decides it.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include "queues/blocking/closing.hpp"
#include "queues/blocking/event_count.hpp"
#include "queues/work_queue.hpp"

namespace irt {

template <template <class> class Inner>
struct Waiting {
  template <class T>
  using Of = ByWorker<Inner<T>, T>;

  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = Inner<T>::summary;
    static constexpr Claims claims = Inner<T>::claims;
    static_assert(!claims.own_queues() && claims.empty != Answer::this_worker,
                  "a worker of this queue sees only a part of it, and would sleep beside the rest");

    Queue(unsigned workers, std::size_t capacity) : inner_(workers, capacity), closing_(workers) {}

    /// Adds `task`; false where the queue inside is full, or closed. Progress: that of the inner
    /// push.
    bool push(unsigned worker, T task) {
      if (!closing_.push(worker, [&] { return inner_.push(worker, std::move(task)); }))
        return false;
      event_.notify_one();
      return true;
    }

    /// Takes a task; false for *empty*, as the queue inside has it. Progress: that of the inner
    /// pop.
    bool pop(unsigned worker, T& task) {
      if (!inner_.pop(worker, task)) return false;
      if constexpr (!empty_is_exact) event_.notify_one();
      return true;
    }

    /// Takes a task, waiting for one; false once the queue is closed and nothing is inside.
    bool pop_wait(unsigned worker, T& task) {
      return wait(worker, task, [this](EventCount::Key key) {
               event_.wait(key);
               return true;
             }) == PopStatus::success;
    }

    /// The same, until `deadline` at most.
    PopStatus pop_wait(unsigned worker, T& task, Deadline deadline) {
      bool last = false;
      return wait(worker, task, [this, deadline, &last](EventCount::Key key) {
        if (last) {
          event_.cancel();
          return false;
        }
        event_.wait(key, deadline);
        // Once more: this sleeper may have been notified.
        last = Deadline::clock::now() >= deadline;
        return true;
      });
    }

    /// As the queue inside, where it has them; who waits is notified.
    std::size_t push_bulk(unsigned worker, std::span<const T> tasks) requires HasBulk<Of<T>, T> {
      std::size_t count = 0;
      closing_.push(worker, [&] {
        count = inner_.push_bulk(worker, tasks);
        return count != 0;
      });
      if (count != 0) event_.notify_all();
      return count;
    }
    std::size_t pop_bulk(unsigned worker, std::span<T> tasks) requires HasBulk<Of<T>, T> {
      const std::size_t count = inner_.pop_bulk(worker, tasks);
      if (!empty_is_exact && count != 0) event_.notify_one();
      return count;
    }

    /// As the queue inside.
    void leave(unsigned worker) requires HasLeave<Of<T>> { inner_.leave(worker); }

    /// Refuses what is pushed from now on, and wakes whoever waits. Wait-free.
    void close() {
      closing_.close();
      event_.notify_all();
    }

   private:
    static constexpr bool empty_is_exact =
        claims.empty == Answer::exact ||
        (claims.empty == Answer::by_ordering && (claims.ordering == Ordering::fifo_real_time ||
                                                 claims.ordering == Ordering::fifo_happens_before));

    /// `sleep(key)` waits for a notification, or does not and answers false: the time is up.
    template <class Sleep>
    PopStatus wait(unsigned worker, T& task, Sleep sleep) {
      for (;;) {
        if (pop(worker, task)) return PopStatus::success;
        const EventCount::Key key = event_.prepare();
        if (pop(worker, task)) {
          event_.cancel();
          return PopStatus::success;
        }
        if (closing_.closed()) {
          event_.cancel();
          closing_.wait_for_pushes();
          return pop(worker, task) ? PopStatus::success : PopStatus::closed;
        }
        if (!sleep(key)) return PopStatus::timed_out;
      }
    }

    Of<T> inner_;
    EventCount event_;
    Closing closing_;
  };
};

}  // namespace irt
