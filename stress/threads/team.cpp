#include "stress/threads/team.hpp"

#include <utility>

namespace irt::stress {

bool Gate::pass() {
  // acq_rel (1): what happened before the earlier arrivals is passed on to the last one
  const unsigned round = round_.load(std::memory_order_relaxed);
  if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
    arrived_.store(0, std::memory_order_relaxed);
    // (2) release: pairs with the acquire load (3)
    round_.store(round + 1, std::memory_order_release);
    return true;
  }
  // (3) acquire: pairs with the release store (2)
  for (unsigned spins = 0; round_.load(std::memory_order_acquire) == round; ++spins) {
    if (abandoned_.load(std::memory_order_relaxed)) return false;
    if (spins % 256 == 255) std::this_thread::yield();
  }
  return true;
}

Team::Team(unsigned threads, Slot* slots)
    : start_(std::make_unique<Gate>(threads)),
      failures_(threads) {  // NOLINT(bugprone-throw-keyword-missing)
  for (unsigned i = 0; i < threads; ++i) {
    threads_.emplace_back([this, i, slots] { work(i, slots[i]); });
  }
}

Team::~Team() {
  stop_ = true;
  // (4) release: pairs with the acquire load (5)
  epoch_.fetch_add(1, std::memory_order_release);
  epoch_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Team::run(const std::function<void(unsigned)>& job) {
  job_ = &job;
  running_.store(size(), std::memory_order_relaxed);
  // (4) release: pairs with the acquire load (5)
  epoch_.fetch_add(1, std::memory_order_release);
  epoch_.notify_all();
  // (7) acquire: pairs with the release decrement (6)
  while (const unsigned left = running_.load(std::memory_order_acquire)) running_.wait(left);
  for (std::exception_ptr& failure : failures_) {
    if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
  }
}

void Team::work(unsigned index, Slot& slot) {
  const Presence presence(slot);
  for (unsigned seen = 0;;) {
    epoch_.wait(seen);
    // (5) acquire: pairs with the release increments (4)
    seen = epoch_.load(std::memory_order_acquire);
    if (stop_) return;
    start_->pass();
    try {
      (*job_)(index);
    } catch (...) {
      failures_[index] = std::current_exception();
    }
    // (6) acq_rel: pairs with the acquire load (7); the last one passes on what the others did
    if (running_.fetch_sub(1, std::memory_order_acq_rel) == 1) running_.notify_all();
  }
}

}  // namespace irt::stress
