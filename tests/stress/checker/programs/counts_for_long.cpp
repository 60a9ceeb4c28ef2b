// finds: not proved
// more steps of one thread than are looked at, and threads that are allowed but were never begun
#include <atomic>
#include <thread>

std::atomic<int> value{0};

int main() {
  std::thread([] { value = 1; }).join();
  while (value.fetch_add(1) < 100'000) {
  }
  return 0;
}
