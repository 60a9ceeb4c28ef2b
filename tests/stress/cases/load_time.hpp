/// A lock, and a list of what was done, in a block that the constructor of a global variable
/// allocates when the code is loaded. Global variables are put back between executions; what they
/// had allocated was not, so that an execution broken off inside the lock left it locked for the
/// next, and an assertion failed before any thread had run. `LoadTime` hangs further blocks into
/// the old one, `LoadTimeGrown` gives it back to the heap and takes a larger one. All healthy.
#pragma once

#include <atomic>
#include <cassert>
#include <cstddef>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

template <class T, bool grown>
class LoadTimeCase {
 public:
  static constexpr std::string_view summary =
      "a spinlock in memory that was allocated at load time";
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time, .survives_no_memory = false};

  LoadTimeCase(unsigned /*workers*/, std::size_t /*capacity*/) { assert(!hub.block->busy.load()); }

  bool push(unsigned /*worker*/, T task) {
    lock();
    tasks_.push_back(task);
    note();
    unlock();
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    lock();
    const bool some = !tasks_.empty();
    if (some) {
      task = tasks_.front();
      tasks_.erase(tasks_.begin());
    }
    unlock();
    return some;
  }

 private:
  struct Note {
    Note* next;
  };
  struct Block {
    std::atomic<bool> busy{false};
    Note* notes = nullptr;
  };
  // Lives as long as the process, as registries do.
  struct Hub {
    Block* block = new Block;
    std::vector<int> calls = std::vector<int>(1);
  };
  static inline Hub hub;

  static void note() {
    if (grown)
      hub.calls.push_back(1);
    else
      hub.block->notes = new Note{hub.block->notes};
  }
  static void lock() {
    while (hub.block->busy.exchange(true, std::memory_order_acquire)) {
    }
  }
  static void unlock() { hub.block->busy.store(false, std::memory_order_release); }

  std::vector<T> tasks_;
};

template <class T>
using LoadTime = LoadTimeCase<T, false>;
template <class T>
using LoadTimeGrown = LoadTimeCase<T, true>;

}  // namespace irt
