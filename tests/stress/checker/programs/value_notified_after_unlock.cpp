// finds with -DWRONG: use after free
// dnp3/opendnp3#106: the setter notifies after its unlock, when the waiter may have found the
// value without a sleep and destroyed the condition variable. Right: the setter notifies under the
// mutex, so that the waiter cannot find the value before the notification is over
#include <condition_variable>
#include <mutex>
#include <thread>

struct Awaited {
  std::mutex mutex;
  std::condition_variable changed;
  bool is_set = false;
  int value = 0;

  void set(int fresh) {
#if defined(WRONG)
    {
      const std::scoped_lock lock(mutex);
      value = fresh;
      is_set = true;
    }
#else
    const std::scoped_lock lock(mutex);
    value = fresh;
    is_set = true;
#endif
    changed.notify_all();
  }

  int get() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [this] { return is_set; });
    return value;
  }
};

int main() {
  auto* answer = new Awaited;
  std::thread setter([answer] { answer->set(7); });
  const int value = answer->get();
  delete answer;
  setter.join();
  if (value != 7) return 1;
  return 0;
}
