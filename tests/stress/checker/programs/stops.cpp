// finds: nothing
#include <atomic>
#include <stop_token>
#include <thread>

std::atomic<int> rounds{0};

int main() {
  std::jthread worker([](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
    }
    rounds.store(1, std::memory_order_relaxed);
  });
  worker.request_stop();
  worker.join();
  return rounds.load(std::memory_order_relaxed) == 1 ? 0 : 1;
}
