// finds: nothing
#include <cassert>
#include <latch>
#include <thread>

int main() {
  std::latch ready(1);
  int value = 0;
  std::thread other([&] {
    ready.wait();
    assert(value == 1);
  });
  value = 1;
  ready.count_down();
  other.join();
  return 0;
}
