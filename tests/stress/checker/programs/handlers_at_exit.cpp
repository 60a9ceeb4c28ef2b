// finds: nothing
#include <cstdlib>
#include <thread>

int order = 0;

int main() {
  std::atexit([] {
    if (order != 1) std::abort();
  });
  std::atexit([] { order = 1; });  // last registered, first called
  std::thread other([] {});
  other.join();
  std::exit(0);
}
