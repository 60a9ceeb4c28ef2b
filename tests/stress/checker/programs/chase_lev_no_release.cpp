// finds: data race
#include <atomic>
#include <cassert>
#include <thread>

// Le, Pop, Cohen and Zappa Nardelli 2013, Figure 1, for one element that owner and thief want.
std::atomic<long> top{0};
std::atomic<long> bottom{0};
std::atomic<int> place{0};
int element = 0;  // what the place stands for
std::atomic<int> taken{0};

void use() {
  assert(element == 1);
  assert(taken.fetch_add(1, std::memory_order_relaxed) == 0);
}

void push() {
  element = 1;
  place.store(1, std::memory_order_relaxed);
  bottom.store(1, std::memory_order_relaxed);
}

void take() {
  const long b = bottom.load(std::memory_order_relaxed) - 1;
  bottom.store(b, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_seq_cst);
  long t = top.load(std::memory_order_relaxed);
  if (t == b && top.compare_exchange_strong(t, t + 1, std::memory_order_seq_cst)) use();
  bottom.store(b + 1, std::memory_order_relaxed);
}

void steal() {
  long t = top.load(std::memory_order_acquire);
  std::atomic_thread_fence(std::memory_order_seq_cst);
  if (t >= bottom.load(std::memory_order_acquire)) return;
  if (place.load(std::memory_order_relaxed) == 1 &&
      top.compare_exchange_strong(t, t + 1, std::memory_order_seq_cst))
    use();
}

int main() {
  std::thread thief(steal);
  push();
  take();
  thief.join();
  return 0;
}
