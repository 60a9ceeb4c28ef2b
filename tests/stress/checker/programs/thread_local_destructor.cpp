// finds: nothing
#include <atomic>
#include <thread>

std::atomic<int> gone{0};

struct Note {
  int mine = 0;
  ~Note() { gone.fetch_add(mine); }
};
Note& note() {
  thread_local Note mine;
  return mine;
}

int main() {
  std::thread a([] { note().mine = 1; });
  std::thread b([] { note().mine = 1; });
  a.join();
  b.join();
  return gone == 2 ? 0 : 1;
}
