#include "renderer/bvh/executor.hpp"

#include <algorithm>

#include "renderer/spin_wait.hpp"

namespace irt {

ThreadExecutor::ThreadExecutor(unsigned threads) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

ThreadExecutor::~ThreadExecutor() {
  gate_ |= leaving;
  gate_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void ThreadExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& job) {
  if (count < 2 || helpers_.empty()) {
    for (std::size_t i = 0; i < count; ++i) job(i);
    return;
  }
  job_ = &job;
  count_ = count;
  // Relaxed: nobody is inside, and the gate publishes it.
  next_.store(0, std::memory_order_relaxed);
  gate_ = (gate_ / one_round + 1) * one_round | open;
  gate_.notify_all();
  work();
  std::uint32_t gate = gate_ &= ~open;
  while ((gate & inside) != 0) {
    if (spin(gate)) continue;
    gate = gate_ |= caller_sleeps;
    if ((gate & inside) != 0) gate_.wait(gate);
    gate = gate_;
  }
}

void ThreadExecutor::work() {
  // Relaxed: only the number matters. The gate carries what the jobs read and write.
  for (std::size_t i = 0; (i = next_.fetch_add(1, std::memory_order_relaxed)) < count_;) (*job_)(i);
}

bool ThreadExecutor::spin(std::uint32_t& seen) const {
  constexpr int attempts = 64;
  SpinWait wait;
  for (int i = 0; i < attempts; ++i) {
    if (const std::uint32_t gate = gate_; gate != seen) {
      seen = gate;
      return true;
    }
    wait();
  }
  return false;
}

void ThreadExecutor::help() {
  std::uint32_t last = 0;  // the round that this helper has been in
  std::uint32_t gate = gate_;
  while ((gate & leaving) == 0) {
    if ((gate & open) == 0 || gate / one_round == last) {
      if (spin(gate)) continue;
      gate_.wait(gate);
      gate = gate_;
    } else if (gate_.compare_exchange_weak(gate, gate + 1)) {
      last = gate / one_round;
      work();
      gate = --gate_;
      if ((gate & inside) == 0 && (gate & caller_sleeps) != 0) gate_.notify_all();
    }
  }
}

}  // namespace irt
