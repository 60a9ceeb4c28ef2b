// finds: data race
#include <thread>

int sum = 0;

int main() {
  const auto work = [](int mine) {
    std::thread below([mine] { sum += mine; });
    below.join();
  };
  std::thread a(work, 1);
  std::thread b(work, 2);
  a.join();
  b.join();
  return 0;
}
