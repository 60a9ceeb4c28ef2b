// finds: nothing
// Right until a weak exchange fails for no reason, which programs_test.cpp asks for.
#include <atomic>
#include <thread>

std::atomic<int> owner{0};

bool take(int who) {
  int nobody = 0;
  return owner.compare_exchange_weak(nobody, who);
}

int main() {
  bool taken = false;
  std::thread other([&taken] { taken = take(1); });
  const bool mine = take(2);
  other.join();
  return mine != taken ? 0 : 1;
}
