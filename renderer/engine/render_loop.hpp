/// The loop of a render thread (Listing 3.3): once, for threads that render and for simulated ones
/// that replay a frame.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "renderer/engine/task_counts.hpp"
#include "renderer/spin_wait.hpp"

namespace irt {

/// `Host` is one render thread: a reference, or so small that it is passed by value. It has
///
///     using Task = ...;  // with std::atomic<bool> queued
///
///     auto& queue();       // push(worker, void*), pop(worker, void*&)
///     unsigned number();   // which worker it is
///     std::vector<Task*>& overflow();            // tasks that the queue had no room for
///     TaskCounts& counts();                      // of all threads
///     bool leaves_when_empty();
///     bool tasks_are_lost();  // asked now and then by who finds nothing: then it is over
///
///     // Traces and shades. Returns the children, with size(). Who is not the first to take the
///     // task may only look at it.
///     auto answer(Task& task, bool first_time);
///     void hand_on(const auto& children, auto put);  // put(Task&) queues one
///
///     // What time went by with: getting a task, a pop that found nothing, waiting for the next.
///     void got();
///     void missed();
///     void waited();
///     void overflowed();  // a push found no room
template <class Host>
class RenderLoop {
 public:
  using Task = typename std::remove_reference_t<Host>::Task;

  /// Queues the tasks that a frame starts with, the `i`th in the name of the thread `host_of(i)`.
  /// None of them works yet. `first` has size() and [], which gives pointers.
  static void deal(const auto& first, TaskCounts& counts, const auto& host_of) {
    counts.open(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) put(host_of(i), *first[i]);
  }

  /// Works on the frame until there is nothing left to do, by the host's termination.
  static void work(Host host) {
    SpinWait wait;
    std::uint32_t misses = 0;
    unsigned watched = host.number();
    while (true) {
      if (Task* task = get(host)) {
        host.got();
        if (misses != 0) {
          misses = 0;
          wait.reset();
          host.counts().rest(host.number(), false);
        }
        process(host, *task);
        continue;
      }
      host.missed();
      if (host.leaves_when_empty()) return;
      if (misses++ == 0) host.counts().rest(host.number(), true);
      // What the tasks wrote is published by the barrier, not by the counts.
      if (host.counts().all_done(watched)) return;
      if (misses % 1024 == 0 && host.tasks_are_lost()) return;
      wait();
      host.waited();
    }
  }

 private:
  static Task* get(Host host) {
    void* task = nullptr;
    if (host.queue().pop(host.number(), task)) return static_cast<Task*>(task);
    auto& overflow = host.overflow();
    if (overflow.empty()) return nullptr;
    Task* kept = overflow.back();
    overflow.pop_back();
    return kept;
  }

  static void put(Host host, Task& task) {
    // Relaxed: published by the push, with the rays.
    task.queued.store(true, std::memory_order_relaxed);
    if (host.queue().push(host.number(), &task)) return;
    host.overflow().push_back(&task);
    host.overflowed();
  }

  static void process(Host host, Task& task) {
    // Relaxed: of two takers exactly one finds true, by atomicity alone.
    const bool first_time = task.queued.exchange(false, std::memory_order_relaxed);
    const auto children = host.answer(task, first_time);
    host.counts().count(host.number(), children.size(), first_time);
    host.hand_on(children, [&](Task& child) { put(host, child); });
  }
};

}  // namespace irt
