// finds: failure
// notifies after the waiter may have seen the flag and destroyed the condition variable
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

std::mutex mutex;
std::optional<std::condition_variable> changed;
bool ready = false;

int main() {
  changed.emplace();
  std::thread setter([] {
    {
      const std::scoped_lock lock(mutex);
      ready = true;
    }
    changed->notify_one();
  });
  {
    std::unique_lock lock(mutex);
    changed->wait(lock, [] { return ready; });
  }
  changed.reset();
  setter.join();
  return 0;
}
