// finds: nothing
// Jiu-xiao/libxr#264, mended: every post wakes a waiter, however many permits there are
#include <atomic>
#include <thread>

struct Semaphore {
  std::atomic<unsigned> permits{0};

  void post() {
    permits.fetch_add(1);
    permits.notify_one();
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
