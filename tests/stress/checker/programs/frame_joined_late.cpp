// finds: use after return
// the thread is joined, but only after the function has returned whose variable it counts in
#include <atomic>
#include <thread>

[[gnu::noinline]] std::thread begin() {
  std::atomic<int> count = 0;
  std::thread counter([&count] { ++count; });
  ++count;
  return counter;
}

int main() {
  begin().join();
  return 0;
}
