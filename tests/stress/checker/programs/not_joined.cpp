// finds: failure
#include <thread>

int main() {
  std::thread forgotten([] {});
  return 0;
}
