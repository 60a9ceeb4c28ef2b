// finds: nothing
// Right until a wait ends for no reason, which programs_test.cpp asks for.
#include <condition_variable>
#include <mutex>
#include <thread>

std::mutex mutex;
std::condition_variable changed;
bool is_ready = false;

int main() {
  std::thread readies([] {
    const std::scoped_lock lock(mutex);
    is_ready = true;
    changed.notify_one();
  });
  bool seen = false;
  {
    std::unique_lock lock(mutex);
    if (!is_ready) changed.wait(lock);
    seen = is_ready;
  }
  readies.join();
  return seen ? 0 : 1;
}
