// finds: nothing
#include <future>
#include <stdexcept>

int main() {
  std::future<int> fails =
      std::async(std::launch::async, []() -> int { throw std::runtime_error("no"); });
  try {
    fails.get();
  } catch (const std::runtime_error&) {
    return 0;
  }
  return 1;
}
