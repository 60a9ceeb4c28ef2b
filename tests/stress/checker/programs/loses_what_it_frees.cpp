// finds: memory leak
#include <atomic>
#include <thread>

std::atomic<int*> shared{nullptr};

int main() {
  const auto replace = [] {
    int* const mine = new int(1);
    int* const old = shared.load();
    shared.store(mine);  // an exchange would not lose what came in between
    delete old;
  };
  std::thread a(replace);
  std::thread b(replace);
  a.join();
  b.join();
  delete shared.load();
  return 0;
}
