// finds: nothing
#include <barrier>
#include <cassert>
#include <thread>

int main() {
  std::barrier both(2);
  int left = 0;
  int right = 0;
  std::thread other([&] {
    left = 1;
    both.arrive_and_wait();
    assert(right == 2);
  });
  right = 2;
  both.arrive_and_wait();
  assert(left == 1);
  other.join();
  return 0;
}
