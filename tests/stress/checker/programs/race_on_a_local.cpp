// finds: data race
#include <thread>

int main() {
  int count = 0;
  std::thread a([&] { ++count; });
  std::thread b([&] { ++count; });
  a.join();
  b.join();
  return 0;
}
