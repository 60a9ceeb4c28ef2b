// finds: nothing
#include <cassert>
#include <mutex>
#include <shared_mutex>
#include <thread>

int main() {
  std::shared_mutex lock;
  int a = 0;
  int b = 0;
  std::thread reader([&] {
    const std::shared_lock held(lock);
    assert(a == b);
  });
  std::thread writer([&] {
    const std::unique_lock held(lock);
    a = b = 1;
  });
  reader.join();
  writer.join();
  return 0;
}
