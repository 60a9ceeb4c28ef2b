// finds: nothing
// glibc bug 12674 (AcademySoftwareFoundation/openexr#46), mended: permits and sleepers share one
// word, so that one step of post releases and learns who sleeps
#include <atomic>
#include <thread>

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

int main() {
  auto* done = new Semaphore;
  std::thread worker([done] { done->post(); });
  done->wait();
  delete done;
  worker.join();
  return 0;
}
