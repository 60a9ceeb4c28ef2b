// finds with -DWRONG: access out of bounds
// apache/bookkeeper#1606: a growing map publishes its new capacity before the table of that size,
// and a reader that holds no lock indexes the old table by the new capacity. Right: the larger
// table is published before its capacity, so that who sees the new capacity sees the table of that
// size
#include <atomic>
#include <thread>

struct Map {
  using Slot = std::atomic<int>;
  std::atomic<unsigned> stamp{0};
  std::atomic<unsigned> capacity{2};
  std::atomic<Slot*> table{new Slot[2]{}};

  Slot* grow() {
    Slot* const old = table.load(std::memory_order_relaxed);
    auto* const larger = new Slot[4]{};
    larger[3].store(old[1].load(std::memory_order_relaxed), std::memory_order_relaxed);
    stamp.store(1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
#if !defined(WRONG)
    table.store(larger, std::memory_order_release);
#endif
    capacity.store(4, std::memory_order_release);
#if defined(WRONG)
    table.store(larger, std::memory_order_release);
#endif
    stamp.store(2, std::memory_order_release);
    return old;
  }

  bool get(unsigned key, int& value) {
    const unsigned before = stamp.load(std::memory_order_acquire);
    if (before % 2 != 0) return false;
    const unsigned bucket = key % capacity.load(std::memory_order_acquire);
    value = table.load(std::memory_order_acquire)[bucket].load(std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_acquire);
    return stamp.load(std::memory_order_relaxed) == before;
  }
};

int main() {
  Map map;
  map.table.load()[1].store(7);
  std::thread reader([&] {
    int value = 7;
    if (map.get(3, value) && value != 7) __builtin_trap();
  });
  Map::Slot* const old = map.grow();
  reader.join();
  delete[] old;
  delete[] map.table.load();
  return 0;
}
