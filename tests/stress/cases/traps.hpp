/// A ring of one place under a lock, which ends the program where a pop comes to a ring that was
/// emptied before: by an instruction that is none, a division by zero, a breakpoint. The fixed one
/// answers.
#pragma once

#include <cstddef>
#include <mutex>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

enum class Trap { none, instruction, division, breakpoint };

template <class T, Trap trap>
class TrapsCase {
 public:
  static constexpr std::string_view summary = "a bag under a lock that traps where it is empty";
  static constexpr Claims claims{};

  TrapsCase(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(task);
    ++pushed_;
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    const std::lock_guard lock(mutex_);
    if (tasks_.empty()) {
      if (pushed_ != 0) stumble(tasks_.size());
      return false;
    }
    task = tasks_.back();
    tasks_.pop_back();
    return true;
  }

 private:
  void stumble(std::size_t left) {
    if constexpr (trap == Trap::instruction) __builtin_trap();
    asm volatile("" : "+r"(left));  // or a compiler that knows it makes the fault another one
    if constexpr (trap == Trap::division) pushed_ = pushed_ % left;
    if constexpr (trap == Trap::breakpoint) asm volatile("int3");
  }

  std::mutex mutex_;
  std::vector<T> tasks_;
  std::size_t pushed_ = 0;
};

template <class T>
struct TrapsBug : TrapsCase<T, Trap::instruction> {
  using TrapsCase<T, Trap::instruction>::TrapsCase;
};
template <class T>
struct DividesBug : TrapsCase<T, Trap::division> {
  using TrapsCase<T, Trap::division>::TrapsCase;
};
template <class T>
struct BreaksBug : TrapsCase<T, Trap::breakpoint> {
  using TrapsCase<T, Trap::breakpoint>::TrapsCase;
};
template <class T>
struct TrapsFixed : TrapsCase<T, Trap::none> {
  using TrapsCase<T, Trap::none>::TrapsCase;
};

}  // namespace irt
