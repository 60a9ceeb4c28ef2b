// finds: nothing
// tikv/rocksdb#423 (pull 424), mended: the filter is published by a release store and found by an
// acquire load
#include <atomic>
#include <mutex>
#include <thread>

struct Filter {
  unsigned bits;
};

struct Table {
  std::mutex mutex;
  std::atomic<Filter*> filter{nullptr};

  Filter* filter_of_table() {
    if (Filter* const made = filter.load(std::memory_order_acquire)) return made;
    const std::scoped_lock lock(mutex);
    if (Filter* const made = filter.load(std::memory_order_relaxed)) return made;
    auto* const fresh = new Filter;
    fresh->bits = 5;
    filter.store(fresh, std::memory_order_release);
    return fresh;
  }
};

int main() {
  Table table;
  std::thread other([&] {
    if (table.filter_of_table()->bits != 5) __builtin_trap();
  });
  const unsigned seen = table.filter_of_table()->bits;
  other.join();
  delete table.filter.load();
  if (seen != 5) return 1;
  return 0;
}
