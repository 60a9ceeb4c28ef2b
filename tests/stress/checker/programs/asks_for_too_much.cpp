// finds: nothing
// more memory than any machine has is not there
#include <cstdint>
#include <cstdlib>
#include <thread>

int main() {
  void* block = nullptr;
  std::thread([&block] {
    volatile std::size_t bytes = SIZE_MAX - 1;
    block = std::malloc(bytes);
  }).join();
  const bool refused = block == nullptr;
  std::free(block);
  return refused ? 0 : 1;
}
