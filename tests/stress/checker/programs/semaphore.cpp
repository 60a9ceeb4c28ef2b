// finds: nothing
#include <cassert>
#include <semaphore>
#include <thread>

int main() {
  std::binary_semaphore turn(0);
  int value = 0;
  std::thread other([&] {
    value = 2;
    turn.release();
  });
  turn.acquire();
  assert(value == 2);
  other.join();
  return 0;
}
