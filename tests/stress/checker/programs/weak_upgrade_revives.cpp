// finds: double free | use after free
// zed#30952: a weak handle looks whether there are owners and then counts itself as one, by two
// steps, so that it owns what the last owner frees in between
#include <atomic>
#include <thread>

struct Entry {
  std::atomic<int> owners{1};
  int* value = new int(1);

  bool upgrade() {
    if (owners.load() == 0) return false;
    owners.fetch_add(1);
    return true;
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
