/// Closes a queue that knows nothing of it: refuses pushes from then on, and says when the last
/// accepted one is inside.
///
/// How it works: each worker shows that it pushes before it looks whether the queue is closed; who
/// has closed it, or seen it closed, waits until nobody shows that any more (Dekker). So a push
/// either sees the queue closed or is waited for.
///
/// Progress: `push` is that of the queue, `close` wait-free, `wait_for_pushes` blocking. A push
/// pays one full barrier.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "queues/cache_line.hpp"

namespace irt {

class Closing {
 public:
  explicit Closing(unsigned workers)
      : workers_(workers), pushing_(std::make_unique<Flag[]>(workers)) {}

  /// What `push()` answers; false, and not asked, where the queue is closed.
  template <class Push>
  bool push(unsigned worker, Push push) {
    std::atomic<bool>& pushing = pushing_[worker].up;
    // seq_cst, as all loads of `closed_` and the loads in `wait_for_pushes`: who found the queue
    // open has been showing itself since before it was closed
    pushing.store(true);
    struct Leave {
      std::atomic<bool>& flag;
      // (1) release: pairs with (2), so that the element is seen
      ~Leave() { flag.store(false, std::memory_order_release); }
    } leave{pushing};
    return !closed_.load() && push();
  }

  void close() { closed_.store(true); }
  [[nodiscard]] bool closed() const { return closed_.load(); }

  /// To be called when the queue is closed: afterwards nothing more comes in.
  void wait_for_pushes() const {
    for (unsigned worker = 0; worker < workers_; ++worker)
      // (2) seq_cst: as above; and its acquire pairs with (1)
      while (pushing_[worker].up.load()) std::this_thread::yield();
  }

 private:
  struct alignas(cache_line_pair) Flag {
    std::atomic<bool> up{false};
  };

  unsigned workers_;
  std::unique_ptr<Flag[]> pushing_;
  std::atomic<bool> closed_{false};
};

}  // namespace irt
