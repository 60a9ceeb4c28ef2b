// finds: data race
#include <mutex>
#include <shared_mutex>
#include <thread>

int main() {
  std::shared_mutex lock;
  int reads = 0;
  const auto read = [&] {
    const std::shared_lock held(lock);
    ++reads;
  };
  std::thread a(read);
  std::thread b(read);
  a.join();
  b.join();
  return 0;
}
