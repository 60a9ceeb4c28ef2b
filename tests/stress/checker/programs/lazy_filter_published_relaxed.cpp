// finds with -DWRONG: data race | uninitialised read
// tikv/rocksdb#423 (pull 424): a filter made at its first use is published and found by relaxed
// steps, so that who finds it need not see what is in it. Right: the filter is published by a
// release store and found by an acquire load
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
#if defined(WRONG)
    if (Filter* const made = filter.load(std::memory_order_relaxed)) return made;
#else
    if (Filter* const made = filter.load(std::memory_order_acquire)) return made;
#endif
    const std::scoped_lock lock(mutex);
    if (Filter* const made = filter.load(std::memory_order_relaxed)) return made;
    auto* const fresh = new Filter;
    fresh->bits = 5;
#if defined(WRONG)
    filter.store(fresh, std::memory_order_relaxed);
#else
    filter.store(fresh, std::memory_order_release);
#endif
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
