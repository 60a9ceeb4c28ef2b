// finds: nothing
#include <atomic>
#include <thread>

std::atomic<int*> shared{nullptr};
std::atomic<int*> hazard{nullptr};

void read() {
  int* const seen = shared.load(std::memory_order_relaxed);
  hazard.store(seen, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_seq_cst);
  if (seen != nullptr && shared.load(std::memory_order_acquire) == seen && *seen != 1)
    __builtin_trap();
  hazard.store(nullptr, std::memory_order_release);
}

void replace() {
  int* const old = shared.exchange(nullptr, std::memory_order_acq_rel);
  std::atomic_thread_fence(std::memory_order_seq_cst);
  while (hazard.load(std::memory_order_acquire) == old) {
  }
  delete old;
}

int main() {
  shared.store(new int(1), std::memory_order_release);
  std::thread reader(read);
  std::thread writer(replace);
  reader.join();
  writer.join();
  return 0;
}
