/// Why the rest of a frame is thrown away.
#pragma once

#include <atomic>
#include <exception>
#include <mutex>

namespace irt {

/// What the application throws ends the frame, and so does `cancel`, which may be null.
class EarlyEnd {
 public:
  explicit EarlyEnd(const std::atomic<bool>* cancel) : cancel_(cancel) {}

  /// Whether there is nothing left to do but to give tasks back. By any number of threads at once.
  [[nodiscard]] bool is_here() const {
    // Relaxed: a flag to stop early; what it protects is ordered by the end of the frame.
    return failed_.load(std::memory_order_relaxed) ||
           (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed));
  }

  /// In a handler: keeps what was thrown, if it is the first of the frame. By any number of threads
  /// at once.
  void note_exception() {
    const std::scoped_lock lock(mutex_);
    if (!error_) error_ = std::current_exception();
    failed_.store(true, std::memory_order_relaxed);
  }

  // Between frames.
  [[nodiscard]] bool is_cancelled() const { return cancel_ != nullptr && *cancel_; }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }
  void reset() {
    error_ = nullptr;
    failed_ = false;
  }

 private:
  const std::atomic<bool>* cancel_;
  std::mutex mutex_;
  std::exception_ptr error_;
  std::atomic<bool> failed_{false};
};

}  // namespace irt
