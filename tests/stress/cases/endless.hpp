/// A bag under a lock whose pop, where it finds nothing, computes: for ever without a look at
/// memory, or for a while. The first is a fault, in whatever way it is written; the second is none,
/// however long it takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt {

enum class Computes {
  nothing,    ///< healthy
  waiting,    ///< bug: it waits for what it has read before
  pausing,    ///< bug: the same, with the instruction for waiting
  polite,     ///< bug: the same, and lets others run
  calling,    ///< bug: the same, with work done by a function
  in_rounds,  ///< bug: numbers that come again and again
  counting,   ///< bug: for 2^64 rounds, which nobody can tell from a long while
  a_while,    ///< healthy: for some tenths of a second
  long_while  ///< healthy: for two seconds and more
};

template <class T, Computes what>
class EndlessCase {
 public:
  static constexpr std::string_view summary = "a bag under a lock whose pop computes";
  static constexpr Claims claims{};

  EndlessCase(unsigned /*workers*/, std::size_t /*capacity*/) {}

  bool push(unsigned /*worker*/, T task) {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(task);
    return true;
  }

  bool pop(unsigned /*worker*/, T& task) {
    bool empty = false;
    {
      const std::lock_guard lock(mutex_);
      empty = tasks_.empty();
      if (!empty) {
        task = tasks_.back();
        tasks_.pop_back();
      }
    }
    if (empty) compute(empty);
    return !empty;
  }

 private:
  // Nothing that a compiler may take for unused or for endless, which it may leave out.
  static void compute(bool empty) {
    std::uint64_t rounds = 0;
    if constexpr (what == Computes::waiting) {
      while (empty) asm volatile("" : "+r"(empty));
    } else if constexpr (what == Computes::pausing) {
      while (empty) __builtin_ia32_pause();
    } else if constexpr (what == Computes::polite) {
      while (empty) std::this_thread::yield();
    } else if constexpr (what == Computes::calling) {
      while (empty) empty = mixed(empty) != 0;
    } else if constexpr (what == Computes::in_rounds) {
      std::uint32_t number = 1;
      while (number != 0) {
        number = number * 5 % 251;
        asm volatile("" : "+r"(number));
      }
    } else if constexpr (what == Computes::counting) {
      while (++rounds != 0) asm volatile("" : "+r"(rounds));
    } else {
      constexpr std::uint64_t end = what == Computes::a_while      ? 300'000'000
                                    : what == Computes::long_while ? 6'000'000'000
                                                                   : 0;
      while (rounds < end) asm volatile("" : "+r"(++rounds));
    }
  }

  [[gnu::noinline]] static std::uint64_t mixed(std::uint64_t number) {
    asm volatile("" : "+r"(number));
    return number * number;
  }

  std::mutex mutex_;
  std::vector<T> tasks_;
};

template <class T>
struct EndlessWaitBug : EndlessCase<T, Computes::waiting> {
  using EndlessCase<T, Computes::waiting>::EndlessCase;
};
template <class T>
struct EndlessPauseBug : EndlessCase<T, Computes::pausing> {
  using EndlessCase<T, Computes::pausing>::EndlessCase;
};
template <class T>
struct EndlessYieldBug : EndlessCase<T, Computes::polite> {
  using EndlessCase<T, Computes::polite>::EndlessCase;
};
template <class T>
struct EndlessCallBug : EndlessCase<T, Computes::calling> {
  using EndlessCase<T, Computes::calling>::EndlessCase;
};
template <class T>
struct EndlessRoundsBug : EndlessCase<T, Computes::in_rounds> {
  using EndlessCase<T, Computes::in_rounds>::EndlessCase;
};
template <class T>
struct EndlessCount : EndlessCase<T, Computes::counting> {
  using EndlessCase<T, Computes::counting>::EndlessCase;
};
template <class T>
struct EndlessFixed : EndlessCase<T, Computes::nothing> {
  using EndlessCase<T, Computes::nothing>::EndlessCase;
};
template <class T>
struct ComputesAWhile : EndlessCase<T, Computes::a_while> {
  using EndlessCase<T, Computes::a_while>::EndlessCase;
};
template <class T>
struct ComputesLong : EndlessCase<T, Computes::long_while> {
  using EndlessCase<T, Computes::long_while>::EndlessCase;
};

}  // namespace irt
