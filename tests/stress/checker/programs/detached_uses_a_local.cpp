// finds: use after return | data race
#include <atomic>
#include <thread>

std::atomic<bool> ready{false};

int use() {
  int local = 1;
  std::thread([&local] {
    ready.store(true, std::memory_order_relaxed);
    local = 2;
  }).detach();
  while (!ready.load(std::memory_order_relaxed)) {
  }
  return local;  // and is gone
}

int main() {
  use();
  return 0;
}
