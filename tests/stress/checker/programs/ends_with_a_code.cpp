// finds: failure
#include <atomic>
#include <thread>

std::atomic<int> first{0};

int main() {
  int won = 0;
  std::thread other([] { first.exchange(1); });
  if (first.exchange(2) == 1) won = 1;  // only if the other was sooner
  other.join();
  return won;
}
