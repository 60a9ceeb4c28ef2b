/// Healthy, lock-free, and long: each call makes `looks` loads before it does anything. Who stops a
/// thread before each of its steps, and runs the others to their end each time, takes a number of
/// steps that grows with the square of that.
#pragma once

#include <atomic>
#include <cstddef>
#include <string_view>

#include "queues/work_queue.hpp"
#include "tests/stress/cases/unpublished.hpp"

namespace irt {

template <class T, int looks>
class ManyStepsCase {
 public:
  static constexpr std::string_view summary = "a bag whose calls begin with many loads";
  static constexpr Claims claims{.push = Progress::lock_free,
                                 .pop = Progress::lock_free,
                                 .bounded = true,
                                 .reclamation = Reclamation::preallocated,
                                 .all_ones_reserved = true};

  ManyStepsCase(unsigned workers, std::size_t capacity) : bag_(workers, capacity) {}

  bool push(unsigned worker, T task) {
    look();
    return bag_.push(worker, task);
  }
  bool pop(unsigned worker, T& task) {
    look();
    return bag_.pop(worker, task);
  }

 private:
  void look() const {
    for (int i = 0; i < looks; ++i) (void)unused_.load(std::memory_order_relaxed);
  }

  std::atomic<int> unused_{0};
  UnpublishedFixed<T> bag_;
};

template <class T>
class ManySteps : public ManyStepsCase<T, 2'000> {
  using ManyStepsCase<T, 2'000>::ManyStepsCase;
};
template <class T>
class FewSteps : public ManyStepsCase<T, 2> {
  using ManyStepsCase<T, 2>::ManyStepsCase;
};

}  // namespace irt
