// finds with -DWRONG: deadlock
// Jiu-xiao/libxr#264: post wakes nobody if there is a permit already, but the waiter that permit
// was for need not have taken it yet, and a second one sleeps on. Right: every post wakes a
// waiter, however many permits there are
#include <atomic>
#include <thread>

struct Semaphore {
  std::atomic<unsigned> permits{0};

  void post() {
#if defined(WRONG)
    if (permits.fetch_add(1) == 0) permits.notify_one();
#else
    permits.fetch_add(1);
    permits.notify_one();
#endif
  }

  void wait() {
    unsigned seen = permits.load();
    while (true) {
      if (seen == 0) {
        permits.wait(0);
        seen = permits.load();
      } else if (permits.compare_exchange_strong(seen, seen - 1)) {
        return;
      }
    }
  }
};

int main() {
  Semaphore semaphore;
  std::thread first([&] { semaphore.wait(); });
  std::thread second([&] { semaphore.wait(); });
  semaphore.post();
  semaphore.post();
  first.join();
  second.join();
  return 0;
}
