/// pingcap/tiflash#3647 (2021): who waits stands in a line and takes itself out when it has run;
/// two pushes before that notify the same one, and the second in line sleeps on.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool Fixed>
class NotifiedTwiceCase {
 public:
  static constexpr std::string_view summary = "a line of waiters; pop parks (tiflash#3647)";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  NotifiedTwiceCase(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    if (closed_) return false;
    held_.push_back(task);
    if (line_.empty()) return true;
    line_.front()->wake();
    if (Fixed) line_.pop_front();
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    return take(task);
  }

  bool pop_wait(unsigned /*worker*/, T& task) {
    std::unique_lock lock(mutex_);
    while (held_.empty() && !closed_) {
      Waiter self;
      line_.push_back(&self);
      self.changed.wait(lock, [&] { return self.woken; });
      std::erase(line_, &self);
    }
    return take(task);
  }

  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    for (Waiter* waiter : line_) waiter->wake();
  }

 private:
  bool take(T& task) {
    if (held_.empty()) return false;
    task = held_.front();
    held_.pop_front();
    return true;
  }

  struct Waiter {
    void wake() {
      woken = true;
      changed.notify_one();
    }
    bool woken = false;
    std::condition_variable changed;
  };

  std::mutex mutex_;
  std::deque<T> held_;
  std::deque<Waiter*>
      line_;  // not std::list: half of it is compiled code, which the checker does not see
  bool closed_ = false;
};

template <class T>
class NotifiedTwiceBug : public NotifiedTwiceCase<T, false> {
  using NotifiedTwiceCase<T, false>::NotifiedTwiceCase;
};
template <class T>
class NotifiedTwiceFixed : public NotifiedTwiceCase<T, true> {
  using NotifiedTwiceCase<T, true>::NotifiedTwiceCase;
};

}  // namespace irt
