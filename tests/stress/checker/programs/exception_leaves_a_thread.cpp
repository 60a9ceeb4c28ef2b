// finds: failure
#include <stdexcept>
#include <thread>

int main() {
  std::thread thrower([] { throw std::runtime_error("nobody catches this"); });
  thrower.join();
  return 0;
}
