// finds: nothing
#include <cassert>
#include <thread>
#include <vector>

int main() {
  std::vector<int> results(3);
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) threads.emplace_back([&results, i] { results[i] = i; });
  for (std::thread& thread : threads) thread.join();
  assert(results[0] + results[1] + results[2] == 3);
  return 0;
}
