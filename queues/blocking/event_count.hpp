/// An event count: lets threads sleep until a condition may have changed, where the condition is
/// kept by other means (D. Vyukov's, after Reed and Kanodia 1979, "Synchronization with
/// Eventcounts and Sequencers").
///
/// Who waits says so, looks at the condition once more, and sleeps only if nobody has notified
/// since:
///
///     const EventCount::Key key = event.prepare();
///     if (condition()) return event.cancel();
///     event.wait(key);
///
/// Who changes the condition calls `notify_one` or `notify_all` afterwards. That is a fence and a
/// look where nobody waits.
///
/// Progress: `notify` is wait-free apart from the kernel. Memory: two words. Bounds: a thread that
/// is stopped between `prepare` and `wait` for exactly 2^32 notifications may sleep through the
/// last.
#pragma once

#include <atomic>
#include <cstdint>
#include <ctime>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "queues/cache_line.hpp"
#include "queues/work_queue.hpp"

namespace irt {

class EventCount {
 public:
  using Key = std::uint32_t;

  /// From here on a notification keeps `wait` from sleeping. Followed by `cancel` or `wait`.
  Key prepare() {
    // relaxed, twice: the fence orders both. It pairs with the one in `notify`: either who notifies
    // sees this waiter, or the waiter's next look sees the change; and who reads the epoch of a
    // notification sees what came before that
    waiters_.fetch_add(1, std::memory_order_relaxed);
    const Key key = epoch_.load(std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    return key;
  }

  void cancel() {
    // relaxed: at worst somebody notifies a waiter who is gone
    waiters_.fetch_sub(1, std::memory_order_relaxed);
  }

  /// Sleeps until the next notification, and now and then for less.
  void wait(Key key) { sleep(key, nullptr); }

  /// The same, until `deadline` at most.
  void wait(Key key, Deadline deadline) {
    using std::chrono::nanoseconds;
    constexpr std::int64_t second = 1'000'000'000;
    const auto since_boot =
        std::chrono::duration_cast<nanoseconds>(deadline.time_since_epoch()).count();
    const std::timespec time{.tv_sec = since_boot / second, .tv_nsec = since_boot % second};
    sleep(key, since_boot > 0 ? &time : &past);
  }

  void notify_one() { notify(1); }
  void notify_all() { notify(most_waiters); }

 private:
  static constexpr int most_waiters = 0x7fffffff;
  static constexpr std::timespec past{};

  void sleep(Key key, const std::timespec* deadline) {
    static_assert(sizeof epoch_ == sizeof(Key) && std::atomic<Key>::is_always_lock_free);
    // Its answer does not matter: the caller looks again.
    syscall(SYS_futex, &epoch_, FUTEX_WAIT_BITSET_PRIVATE, key, deadline, nullptr,
            FUTEX_BITSET_MATCH_ANY);
    cancel();
  }

  void notify(int waiters) {
    // Pairs with the one in `prepare`.
    std::atomic_thread_fence(std::memory_order_seq_cst);
    // relaxed: the fence orders it
    if (waiters_.load(std::memory_order_relaxed) == 0) return;
    // relaxed: likewise
    epoch_.fetch_add(1, std::memory_order_relaxed);
    syscall(SYS_futex, &epoch_, FUTEX_WAKE_PRIVATE, waiters, nullptr, nullptr, 0);
  }

  alignas(cache_line_pair) std::atomic<std::uint32_t> waiters_{0};
  std::atomic<Key> epoch_{0};
};

}  // namespace irt
