/// Waiting pops, closing and bulk methods with one bug each, beside sound ones.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <string_view>

#include "queues/work_queue.hpp"

namespace irt {

/// Its pop waits, by the old name.
template <class T>
class PopsForEver {
 public:
  static constexpr std::string_view summary = "pop waits";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

  PopsForEver(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    held_.push_back(task);
    changed_.notify_one();
    return true;
  }
  bool pop(unsigned /*worker*/, T& task) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !held_.empty(); });
    task = held_.front();
    held_.pop_front();
    return true;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> held_;
};

enum class WaitingBug : std::uint8_t {
  none,
  impatient,      ///< gives up at the first wake-up that brings nothing, whatever the deadline
  deaf,           ///< a pop with a deadline does not hear that the queue is closed
  accepts,        ///< pushes are accepted after close
  leaves_behind,  ///< a push looks whether the queue is closed, and then adds its element
  drops,          ///< what is pushed after close is said to be accepted, and thrown away
  too_soon,       ///< a push is refused although nobody closes the queue, which has no bound
};

template <WaitingBug bug>
struct Waits {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a lock, a condition variable, a deadline";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned /*worker*/, T task) {
      std::unique_lock lock(mutex_);
      if (bug == WaitingBug::too_soon && held_.size() == 1) return false;
      if (closed_ && bug != WaitingBug::accepts) return bug == WaitingBug::drops;
      if (bug == WaitingBug::leaves_behind) {
        lock.unlock();
        lock.lock();
      }
      held_.push_back(task);
      // An impatient one is woken in vain, now and then.
      if (bug == WaitingBug::impatient)
        changed_.notify_all();
      else
        changed_.notify_one();
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(mutex_);
      return take(task);
    }

    bool pop_wait(unsigned /*worker*/, T& task) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return closed_ || !held_.empty(); });
      return take(task);
    }

    PopStatus pop_wait(unsigned /*worker*/, T& task, Deadline deadline) {
      std::unique_lock lock(mutex_);
      while (held_.empty() && (!closed_ || bug == WaitingBug::deaf)) {
        const bool in_time = changed_.wait_until(lock, deadline) == std::cv_status::no_timeout;
        if (!in_time || bug == WaitingBug::impatient) break;
      }
      if (take(task)) return PopStatus::success;
      return closed_ && bug != WaitingBug::deaf ? PopStatus::closed : PopStatus::timed_out;
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
};

template <class T>
using WaitsSound = Waits<WaitingBug::none>::Queue<T>;
template <class T>
using WaitsImpatientBug = Waits<WaitingBug::impatient>::Queue<T>;
template <class T>
using WaitsDeafBug = Waits<WaitingBug::deaf>::Queue<T>;
template <class T>
using WaitsAcceptsBug = Waits<WaitingBug::accepts>::Queue<T>;
template <class T>
using WaitsLeavesBehindBug = Waits<WaitingBug::leaves_behind>::Queue<T>;

template <class T>
using DropsClosedBug = Waits<WaitingBug::drops>::Queue<T>;
template <class T>
using RefusesTooSoonBug = Waits<WaitingBug::too_soon>::Queue<T>;

/// For one producer, which may count without a lock; anybody may close it.
template <class T>
class ClosedInTurn : public WaitsSound<T> {
 public:
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time, .producers = Callers::one};
  using WaitsSound<T>::Queue;

  bool push(unsigned worker, T task) {
    ++pushes_;
    return WaitsSound<T>::push(worker, task);
  }

 private:
  std::size_t pushes_ = 0;
};

/// Sound, and *full* while a pop is on its way, which its claims excuse: a push that is refused
/// then leaves whoever waits for its element waiting.
template <class T>
class FullInFlight {
 public:
  static constexpr std::string_view summary = "a lock; full while a pop is on its way";
  static constexpr Claims claims{
      .ordering = Ordering::fifo_real_time, .bounded = true, .full = Answer::calls_in_flight};

  FullInFlight(unsigned /*workers*/, std::size_t capacity) : capacity_(capacity) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    if (closed_ || held_.size() + leaving_ >= capacity_) return false;
    held_.push_back(task);
    changed_.notify_one();
    return true;
  }
  bool pop(unsigned /*worker*/, T& task) {
    std::unique_lock lock(mutex_);
    return take(lock, task);
  }
  bool pop_wait(unsigned /*worker*/, T& task) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !held_.empty(); });
    return take(lock, task);
  }
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  bool take(std::unique_lock<std::mutex>& lock, T& task) {
    if (held_.empty()) return false;
    task = held_.front();
    held_.pop_front();
    leaving_ += capacity_;
    lock.unlock();
    lock.lock();
    leaving_ -= capacity_;
    return true;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> held_;
  std::size_t capacity_;
  std::size_t leaving_ = 0;  ///< places that pops on their way seem to take
  bool closed_ = false;
};

enum class BulkBug : std::uint8_t {
  none,
  drops_last,  ///< says that it took all, and did not
  backwards,   ///< the elements of a call go in the other way round
  boasts,      ///< says that it found more than there is room for
};

template <BulkBug bug>
struct Bulky {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a lock, several elements in a call";
    static constexpr Claims claims{.ordering = Ordering::fifo_real_time};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned /*worker*/, T task) {
      const std::lock_guard lock(mutex_);
      held_.push_back(task);
      return true;
    }
    bool pop(unsigned worker, T& task) { return pop_bulk(worker, {&task, 1}) != 0; }

    std::size_t push_bulk(unsigned /*worker*/, std::span<const T> tasks) {
      const std::lock_guard lock(mutex_);
      for (std::size_t i = 0; i < tasks.size(); ++i) {
        if (bug == BulkBug::drops_last && i > 0 && i + 1 == tasks.size()) break;
        held_.push_back(tasks[bug == BulkBug::backwards ? tasks.size() - 1 - i : i]);
      }
      return tasks.size();
    }
    std::size_t pop_bulk(unsigned /*worker*/, std::span<T> tasks) {
      const std::lock_guard lock(mutex_);
      const std::size_t count = std::min(tasks.size(), held_.size());
      std::copy_n(held_.begin(), count, tasks.begin());
      held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(count));
      return bug == BulkBug::boasts && tasks.size() > 1 ? tasks.size() + 1 : count;
    }

   private:
    std::mutex mutex_;
    std::deque<T> held_;
  };
};

template <class T>
using BulkySound = Bulky<BulkBug::none>::Queue<T>;
template <class T>
using BulkyDropsBug = Bulky<BulkBug::drops_last>::Queue<T>;
template <class T>
using BulkyBackwardsBug = Bulky<BulkBug::backwards>::Queue<T>;
template <class T>
using BulkyBoastsBug = Bulky<BulkBug::boasts>::Queue<T>;

}  // namespace irt
