/// Channels that take nothing more once they are closed. They say so by refusing a push; they may
/// not drop it, nor refuse one before.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

enum class Refuses : std::uint8_t { what_is_closed, silently, too_soon };

template <class T, Refuses refuses>
class RefusesClosed_ {
 public:
  static constexpr std::string_view summary = "a channel: closed, it takes no more";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  RefusesClosed_(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    if (refuses == Refuses::too_soon && held_.size() == 1) return false;
    if (closed_) return refuses == Refuses::silently;
    held_.push_back(task);
    changed_.notify_one();
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    return take(task);
  }

  bool pop_wait(unsigned /*worker*/, T& task) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !held_.empty(); });
    return take(task);
  }

  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  bool take(T& task) {
    if (held_.empty()) return false;
    task = held_.front();
    held_.pop_front();
    return true;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> held_;
  bool closed_ = false;
};

template <class T>
class RefusesClosed : public RefusesClosed_<T, Refuses::what_is_closed> {
  using RefusesClosed_<T, Refuses::what_is_closed>::RefusesClosed_;
};
template <class T>
class DropsClosedBug : public RefusesClosed_<T, Refuses::silently> {
  using RefusesClosed_<T, Refuses::silently>::RefusesClosed_;
};
template <class T>
class RefusesTooSoonBug : public RefusesClosed_<T, Refuses::too_soon> {
  using RefusesClosed_<T, Refuses::too_soon>::RefusesClosed_;
};
/// For one producer; anybody may close it.
template <class T>
class ClosedInTurn : public RefusesClosed<T> {
 public:
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time, .producers = Callers::one};
  using RefusesClosed<T>::RefusesClosed;

  bool push(unsigned worker, T task) {
    ++pushes_;
    return RefusesClosed<T>::push(worker, task);
  }

 private:
  std::size_t pushes_ = 0;
};

}  // namespace irt
