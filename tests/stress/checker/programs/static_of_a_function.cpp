// finds: nothing
#include <cassert>
#include <memory>
#include <thread>

int& instance() {
  static const std::unique_ptr<int> made = std::make_unique<int>(3);
  return *made;
}

int main() {
  std::thread a([] { assert(instance() == 3); });
  std::thread b([] { assert(instance() == 3); });
  a.join();
  b.join();
  return 0;
}
