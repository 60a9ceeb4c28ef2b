/// Who runs the parts of a parallel build: the caller's task system, or plain threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
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

/// The calling thread and `threads - 1` helpers of its own. A helper that has nothing to do looks
/// for the next call for some ten microseconds, then sleeps. A call waits for the helpers that are
/// at work, not for those that are late: with more threads than cores, it costs little more than
/// the jobs.
class ThreadExecutor final : public Executor {
 public:
  /// 0 threads stand for as many as the machine has cores.
  explicit ThreadExecutor(unsigned threads = 0);
  ~ThreadExecutor() override;

  void for_each(std::size_t count, const std::function<void(std::size_t)>& job) override;

 private:
  // What the gate says. A helper enters by adding 1 while the gate is open, and leaves by
  // subtracting it; only the caller opens and closes, and it opens when all have left.
  static constexpr std::uint32_t inside = 0xffff;  ///< helpers at work
  static constexpr std::uint32_t open = 1u << 16;
  static constexpr std::uint32_t caller_sleeps = 1u << 17;
  static constexpr std::uint32_t leaving = 1u << 18;
  static constexpr std::uint32_t one_round = 1u << 19;  ///< the bits from here up count calls

  void help();
  void work();
  /// Looks at the gate for a while; true once it says something else than `seen`, which it then is.
  bool spin(std::uint32_t& seen) const;

  // No two share a line, nor the pair of lines that is prefetched together.
  alignas(128) std::atomic<std::uint32_t> gate_ = 0;
  // Written before the gate opens, read by those inside.
  const std::function<void(std::size_t)>* job_ = nullptr;
  std::size_t count_ = 0;
  alignas(128) std::atomic<std::size_t> next_ = 0;
  std::vector<std::thread> helpers_;
};

}  // namespace irt
