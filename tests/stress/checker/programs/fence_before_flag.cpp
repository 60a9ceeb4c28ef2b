// finds: nothing
#include <atomic>
#include <cassert>
#include <thread>

int data = 0;
std::atomic<bool> flag{false};

int main() {
  std::thread writer([] {
    data = 1;
    std::atomic_thread_fence(std::memory_order_release);
    flag.store(true, std::memory_order_relaxed);
  });
  std::thread reader([] {
    if (!flag.load(std::memory_order_relaxed)) return;
    std::atomic_thread_fence(std::memory_order_acquire);
    assert(data == 1);
  });
  writer.join();
  reader.join();
  return 0;
}
