// finds: nothing
#include <atomic>
#include <cstdlib>
#include <renderer/engine/task_counts.hpp>
#include <thread>
// A task leads to another one. Who finds none leaves when the counts say that all are done, and
// then sees what they did.

int main() {
  irt::TaskCounts counts(2);
  counts.open(1);
  std::atomic<int> queue{1};
  int first = 0, second = 0;
  const auto work = [&](unsigned me) {
    unsigned watched = me;
    for (bool rests = false; !rests || !counts.all_done(watched);) {
      int task = queue.load(std::memory_order_acquire);
      if (task != 0 && queue.compare_exchange_strong(task, 0)) {
        if (rests) counts.rest(me, rests = false);
        (task == 1 ? first : second) = 1;
        counts.count(me, task == 1 ? 1 : 0, true);
        if (task == 1) queue.store(2, std::memory_order_release);
      } else if (!rests) {
        counts.rest(me, rests = true);
      } else {
        std::this_thread::yield();
      }
    }
    if (first + second != 2) std::abort();
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  return 0;
}
