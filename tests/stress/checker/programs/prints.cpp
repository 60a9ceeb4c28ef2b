// finds: nothing
#include <cstdio>
#include <cstdlib>
#include <thread>

int main() {
  std::thread a([] { std::printf("%d of %s\n", 1, "two"); });
  std::thread b([] { std::puts("hello"); });
  a.join();
  b.join();
  return std::atoi("0");
}
