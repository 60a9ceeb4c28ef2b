// finds: deadlock
#include <atomic>
#include <thread>

std::atomic<int> state{0};

int main() {
  std::thread waiter([] { state.wait(0); });
  state.store(1);  // whoever slept already sleeps on
  waiter.join();
  return 0;
}
