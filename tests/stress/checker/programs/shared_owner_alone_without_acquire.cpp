// finds with -DWRONG: data race
// rust-lang/rust#51780: Arc::get_mut finds itself the only owner by a relaxed load, so what the
// last other owner wrote did not happen before. Right: the load that finds the sole owner acquires
// what the others released
#include <atomic>
#include <thread>

struct Counted {
  std::atomic<int> owners{2};
  int value = 0;

  void drop() {
    if (owners.fetch_sub(1, std::memory_order_release) != 1) return;
    std::atomic_thread_fence(std::memory_order_acquire);
    delete this;
  }

  int* value_if_sole_owner() {
#if defined(WRONG)
    if (owners.load(std::memory_order_relaxed) != 1) return nullptr;
#else
    if (owners.load(std::memory_order_acquire) != 1) return nullptr;
#endif
    return &value;
  }
};

int main() {
  auto* shared = new Counted;
  std::thread other([shared] {
    shared->value = 1;
    shared->drop();
  });
  if (int* mine = shared->value_if_sole_owner()) *mine = 2;
  shared->drop();
  other.join();
  return 0;
}
