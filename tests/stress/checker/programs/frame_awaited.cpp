// finds: nothing
// a function may return once its variables are no longer used; the next one has others in their
// place
#include <atomic>
#include <thread>

[[gnu::noinline]] int sum(int first) {
  std::atomic<int> done = 0;
  int result = first;
  std::thread adder([&] {
    ++result;
    done.store(1, std::memory_order_release);
  });
  adder.detach();
  while (done.load(std::memory_order_acquire) == 0) std::this_thread::yield();
  return result;
}

int main() {
  return sum(1) + sum(2) == 5 ? 0 : 1;
}
