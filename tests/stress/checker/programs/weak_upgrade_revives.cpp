// finds with -DWRONG: double free | use after free
// zed#30952: a weak handle looks whether there are owners and then counts itself as one, by two
// steps, so that it owns what the last owner frees in between. Right: a weak handle counts itself
// as an owner only from a count that is not 0, by one exchange
#include <atomic>
#include <thread>

struct Entry {
  std::atomic<int> owners{1};
  int* value = new int(1);

  bool upgrade() {
#if defined(WRONG)
    if (owners.load() == 0) return false;
    owners.fetch_add(1);
    return true;
#else
    int seen_owners = owners.load();
    while (seen_owners != 0)
      if (owners.compare_exchange_strong(seen_owners, seen_owners + 1)) return true;
    return false;
#endif
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
