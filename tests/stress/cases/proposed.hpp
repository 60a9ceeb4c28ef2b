/// A queue of the shape of the standard's proposal (P0260R20), by the adapter. `wakes_all`: closing
/// wakes everybody who waits, not one.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>

#include "queues/conqueue.hpp"

namespace irt {

enum class QueueStatus : std::uint8_t { success, empty, full, closed, busy };

/// What stands for std::expected, which C++20 lacks.
template <class T>
struct FoundOr {
  std::optional<T> found;
  QueueStatus status = QueueStatus::success;

  explicit operator bool() const { return found.has_value(); }
  T& operator*() { return *found; }
  [[nodiscard]] QueueStatus error() const { return status; }
};

template <class T, bool wakes_all>
class ProposedQueue {
 public:
  explicit ProposedQueue(std::size_t capacity) : capacity_(capacity) {}

  QueueStatus try_push(const T& task) {
    std::unique_lock lock(mutex_, std::defer_lock);
    if (!enter(lock)) return QueueStatus::busy;
    if (closed_) return QueueStatus::closed;
    if (held_.size() == capacity_) return QueueStatus::full;
    held_.push_back(task);
    changed_.notify_one();
    return QueueStatus::success;
  }
  FoundOr<T> try_pop() {
    std::unique_lock lock(mutex_, std::defer_lock);
    if (!enter(lock)) return {std::nullopt, QueueStatus::busy};
    if (held_.empty()) return {std::nullopt, closed_ ? QueueStatus::closed : QueueStatus::empty};
    return {take()};
  }
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !held_.empty(); });
    return held_.empty() ? std::nullopt : std::optional(take());
  }
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    wakes_all ? changed_.notify_all() : changed_.notify_one();
  }

 private:
  // The broken one is never busy, and the sooner searched.
  static bool enter(std::unique_lock<std::mutex>& lock) {
    if (wakes_all) return lock.try_lock();
    lock.lock();
    return true;
  }
  T take() {
    T task = held_.front();
    held_.pop_front();
    return task;
  }

  std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> held_;
  bool closed_ = false;
};

template <class T>
using ProposedSound = ProposedQueue<T, true>;
template <class T>
using ProposedDeafQueue = ProposedQueue<T, false>;

template <class T, template <class...> class Queue>
class ProposedAdapter : public Conqueue<Queue>::template Adapter<T> {
 public:
  static constexpr std::string_view summary = "a queue as the standard's proposal has it";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time, .bounded = true};
  using Conqueue<Queue>::template Adapter<T>::Adapter;
};

template <class T>
class Proposed : public ProposedAdapter<T, ProposedSound> {
  using ProposedAdapter<T, ProposedSound>::ProposedAdapter;
};
template <class T>
class ProposedDeafBug : public ProposedAdapter<T, ProposedDeafQueue> {
  using ProposedAdapter<T, ProposedDeafQueue>::ProposedAdapter;
};

}  // namespace irt
