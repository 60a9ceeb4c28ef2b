// finds: nothing
#include <atomic>
#include <thread>

std::atomic<int> sum{0};

int main() {
  const auto work = [](int mine) {
    std::thread below([mine] { sum.fetch_add(mine, std::memory_order_relaxed); });
    below.join();
  };
  std::thread a(work, 1);
  std::thread b(work, 2);
  a.join();
  b.join();
  return sum.load(std::memory_order_relaxed) == 3 ? 0 : 1;
}
