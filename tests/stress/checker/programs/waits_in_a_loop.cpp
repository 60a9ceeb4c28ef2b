// finds: nothing
// Its loops go round as often as waits end and exchanges fail for no reason: with these, too, there
// are finitely many executions.
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

std::mutex mutex;
std::condition_variable changed;
bool is_ready = false;
std::atomic<int> readied{0};

void count() {
  int seen = readied.load(std::memory_order_relaxed);
  while (!readied.compare_exchange_weak(seen, seen + 1, std::memory_order_relaxed)) {
  }
}

int main() {
  std::thread readies([] {
    count();
    const std::scoped_lock lock(mutex);
    is_ready = true;
    changed.notify_one();
  });
  {
    std::unique_lock lock(mutex);
    while (!is_ready) changed.wait(lock);
  }
  count();
  readies.join();
  return readied.load() == 2 ? 0 : 1;
}
