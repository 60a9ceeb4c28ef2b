// finds: nothing
#include <atomic>
#include <thread>

struct Counted {
  std::atomic<int> references{2};
  int value = 0;
};

void release(Counted* object) {
  if (object->references.fetch_sub(1, std::memory_order_release) != 1) return;
  std::atomic_thread_fence(std::memory_order_acquire);
  delete object;
}

int main() {
  auto* const object = new Counted;
  std::thread a([object] {
    object->value = 1;
    release(object);
  });
  std::thread b([object] { release(object); });
  a.join();
  b.join();
  return 0;
}
