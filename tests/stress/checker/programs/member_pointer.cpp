// finds with -DWRONG: data race
#include <atomic>
#include <thread>

struct Handlers {
  int quiet() { return 1; }
  int loud() { return 2; }
};

int (Handlers::*handler)() = &Handlers::quiet;
std::atomic<bool> is_set{false};

int main() {
  std::thread sets([] {
    handler = &Handlers::loud;
#ifdef WRONG
    is_set.store(true, std::memory_order_relaxed);
#else
    is_set.store(true, std::memory_order_release);
#endif
  });
  int called = 2;
  Handlers handlers;
  if (is_set.load(std::memory_order_acquire)) called = (handlers.*handler)();
  sets.join();
  return called == 2 ? 0 : 1;
}
