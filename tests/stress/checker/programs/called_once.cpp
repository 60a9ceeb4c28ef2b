// finds: nothing
#include <cassert>
#include <mutex>
#include <thread>

int main() {
  std::once_flag once;
  int made = 0;
  const auto use = [&] {
    std::call_once(once, [&] { ++made; });
    assert(made == 1);
  };
  std::thread a(use);
  std::thread b(use);
  a.join();
  b.join();
  return 0;
}
