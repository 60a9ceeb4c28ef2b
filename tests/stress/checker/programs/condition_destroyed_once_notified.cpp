// finds: nothing
// who was notified may still be on its way out of a condition variable that is destroyed
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

std::mutex mutex;
std::optional<std::condition_variable> changed;
bool ready = false;
bool waits = false;

int main() {
  changed.emplace();
  std::thread waiter([] {
    std::unique_lock lock(mutex);
    if (ready) return;
    waits = true;
    changed->wait(lock);
  });
  {
    const std::scoped_lock lock(mutex);
    ready = true;
    if (waits) changed->notify_one();
    changed.reset();
  }
  waiter.join();
  return 0;
}
