// finds with -DWRONG: deadlock
// ARM-software/synchronization-benchmarks#62: a thread counts itself in by one step and looks for
// the full count by another, so that two resets follow one round and the second loses an arrival.
// Right: the step that counts a thread in also says whether it is the last
#include <atomic>
#include <thread>

struct Barrier {
  static constexpr unsigned threads = 2;
  std::atomic<unsigned> arrived{0};
  std::atomic<unsigned> round{0};

  void arrive_and_wait() {
    const unsigned mine = round.load();
#if defined(WRONG)
    arrived.fetch_add(1);
    // Both may find the count full here, and each takes itself for the last.
    if (arrived.load() == threads) {
#else
    if (arrived.fetch_add(1) + 1 == threads) {
#endif
      arrived.store(0);
      round.store(mine + 1);
      round.notify_all();
    } else {
      round.wait(mine);
    }
  }
};

int main() {
  Barrier barrier;
  std::thread other([&] {
    barrier.arrive_and_wait();
    barrier.arrive_and_wait();
  });
  barrier.arrive_and_wait();
  barrier.arrive_and_wait();
  other.join();
  return 0;
}
