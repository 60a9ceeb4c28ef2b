/// Queues that break one promise each, in the plainest way, and one that breaks none.
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::stress {

enum class Defect {
  none,
  loses,
  doubles,
  reorders,
  lies_empty,
  crashes,
  hangs,
  throws,
  leaks,
  grows
};

template <Defect defect, Progress claimed = Progress::blocking>
struct Broken {
  template <class T>
  class Queue {
   public:
    static constexpr std::string_view summary = "a mutex, and a defect";
    static constexpr Claims claims{
        .ordering = Ordering::fifo_real_time, .push = claimed, .pop = claimed};

    Queue(unsigned /*workers*/, std::size_t /*capacity*/) {}

    bool push(unsigned /*worker*/, T task) {
      if constexpr (defect == Defect::throws) {
        auto node = std::make_unique<int>(1);  // may throw, after the element is in
        const std::lock_guard lock(mutex_);
        held_.push_back(task);
        nodes_.push_back(std::move(node));
        return true;
      }
      if constexpr (defect == Defect::leaks) {
        scratch_ = new int(1);
        const auto second = std::make_unique<int>(2);  // may throw: the first is lost
        delete scratch_.exchange(nullptr);
      }
      const std::lock_guard lock(mutex_);
      const unsigned count = ++count_;
      if (defect == Defect::loses && count % 97 == 0) return true;
      if (defect == Defect::crashes && count % 97 == 0) *static_cast<volatile int*>(nullptr) = 1;
      if (defect == Defect::grows) nodes_.push_back(std::make_unique<int>(1));
      held_.push_back(task);
      if (defect == Defect::doubles && count % 97 == 0) held_.push_back(task);
      return true;
    }

    bool pop(unsigned /*worker*/, T& task) {
      const std::lock_guard lock(mutex_);
      const unsigned count = ++count_;
      if (defect == Defect::lies_empty && count % 97 == 0) return false;
      // NOLINTNEXTLINE(bugprone-infinite-loop): the defect
      while (defect == Defect::hangs && count % 997 == 0) std::this_thread::yield();
      if (held_.empty()) return false;
      if (defect == Defect::reorders && held_.size() > 2 && count % 97 == 0) {
        std::swap(held_[0], held_[1]);
      }
      task = held_.front();
      held_.pop_front();
      if (defect == Defect::throws && !nodes_.empty()) nodes_.pop_back();
      return true;
    }

   private:
    std::mutex mutex_;
    std::deque<T> held_;
    std::vector<std::unique_ptr<int>> nodes_;
    std::atomic<int*> scratch_{nullptr};
    unsigned count_ = 0;
  };
};

template <Defect defect, Progress claimed = Progress::blocking>
QueueEntry broken_entry() {
  return queue_entry<Broken<defect, claimed>::template Queue>("broken");
}

}  // namespace irt::stress
