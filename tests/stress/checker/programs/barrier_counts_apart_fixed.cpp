// finds: nothing
// ARM-software/synchronization-benchmarks#62, mended: the step that counts a thread in also says
// whether it is the last
#include <atomic>
#include <thread>

struct Barrier {
  static constexpr unsigned threads = 2;
  std::atomic<unsigned> arrived{0};
  std::atomic<unsigned> round{0};

  void arrive_and_wait() {
    const unsigned mine = round.load();
    if (arrived.fetch_add(1) + 1 == threads) {
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
