// finds: livelock
// a thread that makes more steps than are looked at, while others that are allowed were never begun
#include <atomic>
#include <thread>

std::atomic<int> value{0};

int main() {
  std::thread other([] { value = 1; });
  int seen = 0;
  while (seen >= 0) seen = value.exchange(seen + 1);
  other.join();
  return 0;
}
