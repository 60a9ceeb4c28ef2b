// finds: data race
#include <thread>

int main() {
  int count = 0;
  std::thread other([&] { ++count; });
  ++count;  // before the other is joined
  other.join();
  return count - 2;
}
