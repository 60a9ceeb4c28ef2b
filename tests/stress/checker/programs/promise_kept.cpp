// finds: nothing
#include <future>
#include <thread>

int main() {
  std::promise<int> promise;
  std::future<int> given = promise.get_future();
  std::thread other([&promise] { promise.set_value(4); });
  const int value = given.get();
  other.join();
  return value == 4 ? 0 : 1;
}
