// finds with -DWRONG: use after free
// glibc bug 12674 (AcademySoftwareFoundation/openexr#46): sem_post looks for waiters in the
// semaphore after the waiter may have freed it. Right: permits and sleepers share one word, so that
// one step of post releases and learns who sleeps
#include <atomic>
#include <thread>

#if defined(WRONG)
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
#else
struct Semaphore {
  static constexpr unsigned sleeper = 1U << 16;
  static constexpr unsigned permit_mask = sleeper - 1;
  std::atomic<unsigned> word{0};

  void post() {
    // Waking by address alone is allowed to hit freed memory; it does not read it.
    std::atomic<unsigned>* const address = &word;
    if (word.fetch_add(1) >= sleeper) address->notify_one();
  }

  void wait() {
    unsigned seen = word.load();
    while (true) {
      if ((seen & permit_mask) != 0) {
        if (word.compare_exchange_strong(seen, seen - 1)) return;
        continue;
      }
      seen = word.fetch_add(sleeper) + sleeper;
      if ((seen & permit_mask) == 0) word.wait(seen);
      seen = word.fetch_sub(sleeper) - sleeper;
    }
  }
};
#endif

int main() {
  auto* done = new Semaphore;
  std::thread worker([done] { done->post(); });
  done->wait();
  delete done;
  worker.join();
  return 0;
}
