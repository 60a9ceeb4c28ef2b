/// A team of threads that runs one job after the other, starting each at the same moment.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "stress/threads/slot.hpp"

namespace irt::stress {

/// A barrier for more threads than cores: spins briefly, then yields.
class Gate {
 public:
  explicit Gate(unsigned threads) : threads_(threads) {}
  /// Waits until all have come. Whatever happened before one's arrival happens before another's
  /// return. Leaves early, with false, once `abandon()` was called.
  bool pass();
  /// Lets everybody through, for good: somebody will not come.
  void abandon() { abandoned_.store(true, std::memory_order_relaxed); }

 private:
  unsigned threads_;
  std::atomic<unsigned> arrived_{0};
  std::atomic<unsigned> round_{0};
  std::atomic<bool> abandoned_{false};
};

class Team {
 public:
  /// `slots` outlives the team and has one slot per thread.
  Team(unsigned threads, Slot* slots);
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team();

  [[nodiscard]] unsigned size() const { return static_cast<unsigned>(threads_.size()); }

  /// Runs `job(i)` on thread i, for all i at once, and waits for all. Throws the first exception
  /// that a job threw.
  void run(const std::function<void(unsigned)>& job);

 private:
  void work(unsigned index, Slot& slot);

  const std::function<void(unsigned)>* job_ = nullptr;
  std::atomic<unsigned> epoch_{0};
  std::atomic<unsigned> running_{0};
  bool stop_ = false;
  std::unique_ptr<Gate> start_;
  std::vector<std::exception_ptr> failures_;
  std::vector<std::thread> threads_;
};

}  // namespace irt::stress
