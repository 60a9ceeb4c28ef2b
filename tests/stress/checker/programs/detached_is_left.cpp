// finds: nothing
#include <atomic>
#include <thread>

std::atomic<bool> stop{false};

int main() {
  std::thread([] {
    while (!stop) {
    }
  }).detach();
  return 0;  // it need not end
}
