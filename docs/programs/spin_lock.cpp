// finds with -DWRONG: data race
#include <atomic>
#include <thread>

class SpinLock {
 public:
  void lock() {
    while (held_.exchange(true, std::memory_order_acquire)) {
    }
  }
  void unlock() {
#if defined(WRONG)
    held_.store(false, std::memory_order_relaxed);
#else
    held_.store(false, std::memory_order_release);  // for the next one's acquire
#endif
  }

 private:
  std::atomic<bool> held_{false};
};

int main() {
  SpinLock lock;
  int inside = 0;
  const auto enter = [&] {
    lock.lock();
    ++inside;
    lock.unlock();
  };
  std::thread other(enter);
  enter();
  other.join();
  return inside == 2 ? 0 : 1;
}
