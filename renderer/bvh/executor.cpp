#include "renderer/bvh/executor.hpp"

#include <algorithm>

namespace irt {

ThreadExecutor::ThreadExecutor(unsigned threads) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < threads; ++i) helpers_.emplace_back([this] { help(); });
}

ThreadExecutor::~ThreadExecutor() {
  {
    const std::lock_guard lock(mutex_);
    leaving_ = true;
  }
  changed_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

void ThreadExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& job) {
  if (count < 2 || helpers_.empty()) {
    for (std::size_t i = 0; i < count; ++i) job(i);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    job_ = &job;
    count_ = count;
    next_.store(0, std::memory_order_relaxed);  // the mutex orders it before the helpers' reads
    busy_ = helpers_.size();
    ++round_;
  }
  changed_.notify_all();
  work();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return busy_ == 0; });
}

void ThreadExecutor::work() {
  // Relaxed: only the number matters. The mutex carries what the jobs write to the caller.
  for (std::size_t i = 0; (i = next_.fetch_add(1, std::memory_order_relaxed)) < count_;) (*job_)(i);
}

void ThreadExecutor::help() {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return leaving_ || round_ != seen; });
    if (leaving_) return;
    seen = round_;
    lock.unlock();
    work();
    lock.lock();
    if (--busy_ == 0) changed_.notify_all();
  }
}

}  // namespace irt
