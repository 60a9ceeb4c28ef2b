/// Who runs the parts of a parallel build: the caller's task system, or plain threads.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace irt {

/// Runs independent jobs. A build calls it from one thread at a time, never from within a job.
class Executor {
 public:
  Executor() = default;
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  virtual ~Executor() = default;

  /// Calls `job(i)` once for every i in [0, count), on any threads in any order; returns when all
  /// have returned. Jobs do not throw.
  virtual void for_each(std::size_t count, const std::function<void(std::size_t)>& job) = 0;
};

/// The calling thread and `threads - 1` of its own, which sleep between calls.
class ThreadExecutor final : public Executor {
 public:
  /// 0 threads stand for as many as the machine has cores.
  explicit ThreadExecutor(unsigned threads = 0);
  ~ThreadExecutor() override;

  void for_each(std::size_t count, const std::function<void(std::size_t)>& job) override;

 private:
  void help();
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void(std::size_t)>* job_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_ = 0;
  std::size_t busy_ = 0;  ///< helpers that have not finished the present round
  std::uint64_t round_ = 0;
  bool leaving_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace irt
