// finds: use after free
// glibc bug 12674 (AcademySoftwareFoundation/openexr#46): sem_post looks for waiters in the
// semaphore after the waiter may have freed it
#include <atomic>
#include <thread>

struct Semaphore {
  std::atomic<unsigned> permits{0};
  std::atomic<unsigned> sleepers{0};

  void post() {
    permits.fetch_add(1);
    // The permit may be taken without sleeping, so nothing keeps *this alive from here on.
    if (sleepers.load() != 0) permits.notify_one();
  }

  void wait() {
    for (unsigned seen = permits.load();;) {
      if (seen != 0) {
        if (permits.compare_exchange_strong(seen, seen - 1)) return;
        continue;
      }
      sleepers.fetch_add(1);
      permits.wait(0);
      sleepers.fetch_sub(1);
      seen = permits.load();
    }
  }
};

int main() {
  auto* done = new Semaphore;
  std::thread worker([done] { done->post(); });
  done->wait();
  delete done;
  worker.join();
  return 0;
}
