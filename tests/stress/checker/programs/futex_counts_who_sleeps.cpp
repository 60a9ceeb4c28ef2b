// finds: nothing
// a kernel looks and puts to sleep in one step: whom it has not put to sleep it does not wake
#include <atomic>
#include <cerrno>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

int main() {
  std::atomic<int> word{0};
  long woken = 0;
  bool slept = true;
  std::thread sleeper(
      [&] { slept = syscall(SYS_futex, &word, FUTEX_WAIT, 0, nullptr) == 0 || errno != EAGAIN; });
  std::thread waker([&] {
    word.store(1);
    woken = syscall(SYS_futex, &word, FUTEX_WAKE, 1);
  });
  sleeper.join();
  waker.join();
  return woken == 1 && !slept ? 1 : 0;
}
