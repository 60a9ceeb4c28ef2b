// finds with -DWRONG: deadlock
// zephyr#60145 (pull 60231): readers that leave look whether they are the last before they count
// themselves out, so that none finds itself the last and the writer sleeps on. Right: the step
// that counts a reader out says whether it was the last
#include <atomic>
#include <cassert>
#include <semaphore>
#include <thread>

struct GuardedValue {
  std::atomic<int> readers{0};
  std::binary_semaphore free{1};
  int value = 1;

  void lock_shared() {
    if (readers.fetch_add(1) == 0) free.acquire();
  }

  void unlock_shared() {
#if defined(WRONG)
    if (readers.load() == 1) free.release();
    readers.fetch_sub(1);
#else
    if (readers.fetch_sub(1) == 1) free.release();
#endif
  }

  void lock() {
    free.acquire();
  }
  void unlock() {
    free.release();
  }
};

int main() {
  GuardedValue lock;
  lock.lock_shared();
  lock.lock_shared();
  std::thread reader([&lock] {
    assert(lock.value == 1);
    lock.unlock_shared();
  });
  lock.unlock_shared();
  lock.lock();
  lock.value = 2;
  lock.unlock();
  reader.join();
  return 0;
}
