// finds: nothing
// a compiled function of the C++ library leaves its own frame when it returns, not its caller's
#include <atomic>
#include <list>
#include <map>
#include <thread>

int main() {
  std::atomic<int> count{0};
  std::thread counter([&count] { ++count; });
  std::list<int> list{3, 1, 2};
  list.reverse();
  std::map<int, int> map;
  for (const int key : list) map[key] = key;
  map.erase(1);
  ++count;
  counter.join();
  return count == 2 && map.size() == 2 ? 0 : 1;
}
