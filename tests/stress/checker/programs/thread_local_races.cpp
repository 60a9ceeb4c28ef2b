// finds: data race
#include <thread>

int gone = 0;

struct Note {
  int mine = 0;
  ~Note() { gone += mine; }
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
  return 0;
}
