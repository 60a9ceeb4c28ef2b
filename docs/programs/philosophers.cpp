// finds with -DWRONG: deadlock
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

int main() {
  constexpr unsigned philosophers = 3;
  std::mutex forks[philosophers];
  std::vector<std::thread> table;
  for (unsigned i = 0; i < philosophers; ++i)
    table.emplace_back([&forks, i] {
      unsigned first = i;
      unsigned second = (i + 1) % philosophers;
#if !defined(WRONG)
      if (second < first) std::swap(first, second);  // all take the lower fork first
#endif
      const std::lock_guard left(forks[first]);
      const std::lock_guard right(forks[second]);
    });
  for (std::thread& philosopher : table) philosopher.join();
  return 0;
}
