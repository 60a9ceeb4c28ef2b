// finds: deadlock
#include <condition_variable>
#include <mutex>
#include <thread>

int main() {
  std::mutex lock;
  std::condition_variable changed;
  bool ready = false;
  std::thread waiter([&] {
    std::unique_lock held(lock);
    changed.wait(held);  // without asking whether it is ready already
  });
  {
    const std::lock_guard held(lock);
    ready = true;
  }
  changed.notify_one();
  waiter.join();
  return ready ? 0 : 1;
}
