// finds with -DWRONG: failure
// python/cpython#121368: the reader's second look at the sequence is no fence after its reads, so
// that it accepts a torn entry. Right: a fence lies between the reads and the second look at the
// sequence
#include <atomic>
#include <cassert>
#include <thread>

struct CachedEntry {
  std::atomic<unsigned> sequence{0};
  std::atomic<int> key{0};
  std::atomic<int> value{0};

  void replace(int fresh) {
    unsigned even = 0;
    sequence.compare_exchange_strong(even, 1);
    std::atomic_thread_fence(std::memory_order_release);
    key.store(fresh, std::memory_order_relaxed);
    value.store(fresh, std::memory_order_relaxed);
    sequence.store(2, std::memory_order_release);
  }

  bool read(int& seen_key, int& seen_value) {
    const unsigned before = sequence.load(std::memory_order_acquire);
    if (before % 2 != 0) return false;
    seen_key = key.load(std::memory_order_relaxed);
    seen_value = value.load(std::memory_order_relaxed);
#if defined(WRONG)
    // An acquire load orders only what follows it: the two reads above may still move below.
    return sequence.load(std::memory_order_acquire) == before;
#else
    std::atomic_thread_fence(std::memory_order_acquire);
    return sequence.load(std::memory_order_relaxed) == before;
#endif
  }
};

int main() {
  CachedEntry entry;
  std::thread writer([&] { entry.replace(7); });
  int key = 0;
  int value = 0;
  if (entry.read(key, value)) assert(key == value);
  writer.join();
  return 0;
}
