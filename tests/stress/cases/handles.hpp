/// A list of which a handle takes two elements at a time. What it has left it gives back when its
/// thread leaves; or forgets, or gives back beside the lock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

enum class Leaving : std::uint8_t { gives_back, forgets, beside_the_lock };

template <class T, Leaving leaving, Callers callers = Callers::many>
class TwoAtATimeCase {
 public:
  static constexpr std::string_view summary = "a list of which a handle takes two at a time";
  static constexpr Claims claims{.ordering = Ordering::unordered,
                                 .empty = Answer::this_worker,
                                 .producers = callers,
                                 .consumers = callers};

  class Handle {
   public:
    explicit Handle(TwoAtATimeCase& queue) : queue_(queue) {}
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
      if (!kept_ || leaving == Leaving::forgets) return;
      std::unique_lock lock(queue_.mutex_, std::defer_lock);
      if (leaving == Leaving::gives_back) lock.lock();
      queue_.held_.push_front(*kept_);
    }

   private:
    friend TwoAtATimeCase;
    TwoAtATimeCase& queue_;
    std::optional<T> kept_;
  };

  TwoAtATimeCase(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(Handle& /*handle*/, T task) {
    const std::lock_guard lock(mutex_);
    held_.push_back(task);
    return true;
  }

  bool pop(Handle& handle, T& task) {
    if (handle.kept_) {
      task = *handle.kept_;
      handle.kept_.reset();
      return true;
    }
    const std::lock_guard lock(mutex_);
    if (held_.empty()) return false;
    task = held_.front();
    held_.pop_front();
    if (!held_.empty()) {
      handle.kept_ = held_.front();
      held_.pop_front();
    }
    return true;
  }

 private:
  std::mutex mutex_;
  std::deque<T> held_;
};

template <class T>
using TwoAtATime = TwoAtATimeCase<T, Leaving::gives_back>;
/// One worker pushes and one pops, by whichever threads.
template <class T>
using TwoAtATimeForOne = TwoAtATimeCase<T, Leaving::gives_back, Callers::one>;
template <class T>
using TwoAtATimeForgets = TwoAtATimeCase<T, Leaving::forgets>;
template <class T>
using TwoAtATimeRaces = TwoAtATimeCase<T, Leaving::beside_the_lock>;

}  // namespace irt
