// finds: nothing
// zed#30952, mended: a weak handle counts itself as an owner only from a count that is not 0, by
// one exchange
#include <atomic>
#include <thread>

struct Entry {
  std::atomic<int> owners{1};
  int* value = new int(1);

  bool upgrade() {
    int seen_owners = owners.load();
    while (seen_owners != 0)
      if (owners.compare_exchange_strong(seen_owners, seen_owners + 1)) return true;
    return false;
  }

  void release() {
    if (owners.fetch_sub(1) == 1) delete value;
  }
};

int main() {
  Entry entry;
  int seen = 1;
  std::thread weak([&] {
    if (!entry.upgrade()) return;
    seen = *entry.value;
    entry.release();
  });
  entry.release();
  weak.join();
  if (seen != 1) return 1;
  return 0;
}
