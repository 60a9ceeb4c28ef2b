// finds: deadlock
#include <future>
#include <thread>

int main() {
  std::promise<int> first;
  std::promise<int> second;
  std::thread other([&] {
    first.get_future().wait();
    second.set_value(1);
  });
  second.get_future().wait();
  first.set_value(1);
  other.join();
  return 0;
}
