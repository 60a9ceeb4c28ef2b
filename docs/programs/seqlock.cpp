// finds with -DWRONG: failure
#include <atomic>
#include <cassert>
#include <thread>

// Boehm 2012, "Can Seqlocks Get Along With Programming Language Memory Models?", Figure 6.
class Point {
 public:
  void set(int x, int y) {
    const unsigned before = sequence_.load(std::memory_order_relaxed);
    sequence_.store(before + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);  // for who sees the new x or y
    x_.store(x, std::memory_order_relaxed);
    y_.store(y, std::memory_order_relaxed);
    sequence_.store(before + 2, std::memory_order_release);
  }
  bool read(int& x, int& y) const {
    const unsigned before = sequence_.load(std::memory_order_acquire);
    x = x_.load(std::memory_order_relaxed);
    y = y_.load(std::memory_order_relaxed);
#if !defined(WRONG)
    std::atomic_thread_fence(std::memory_order_acquire);  // of who wrote x or y
#endif
    return before % 2 == 0 && sequence_.load(std::memory_order_relaxed) == before;
  }

 private:
  std::atomic<unsigned> sequence_{0};
  std::atomic<int> x_{0};
  std::atomic<int> y_{0};
};

int main() {
  Point point;
  std::thread writer([&] { point.set(3, 3); });
  int x = 0;
  int y = 0;
  if (point.read(x, y)) assert(x == y);
  writer.join();
  return 0;
}
